"""What may be wrong with a scan: repaired where that is safe, said where it is not."""

from dataclasses import replace
from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float, Int

from skinnet.errors import InputError
from skinnet.mesh._orientation import (
    areas,
    find_inconsistent_faces,
    flip_triangles,
    is_inside_out,
    label_face_components,
)
from skinnet.mesh._texture_atlas import wrap_coordinates
from skinnet.mesh._topology import edge_keys, half_edges
from skinnet.mesh.mesh import Mesh

DAMAGED = 0.1
"""Largest share of vertices that are not finite, or of faces without an area, that is left out."""

KEPT = 0.1
"""Components with at least this share of the area are kept beside the largest."""

PLACEHOLDER = 8
"""A texture with a side of fewer texels than this is none."""

JUTTING = 0.01
"""Texture coordinates may leave their tile by this much."""

UNITS = {"metres": 1000.0, "centimetres": 10.0, "millimetres": 1.0, "micrometres": 0.001}
FACE = (100.0, 600.0)
"""Longest side of the box about a face, a head, or a head with shoulders, in millimetres."""

Choice = Bool[np.ndarray, "triangles"]


class RepairedMesh(NamedTuple):
    """A mesh that can be worked with, and a sentence for each thing that was changed."""

    mesh: Mesh
    notes: list[str]


class LengthUnit(NamedTuple):
    """Millimetres in a mesh's unit, and a sentence about it."""

    millimetres: float
    note: str


def repair_mesh(mesh: Mesh, need_texture: bool = False) -> RepairedMesh:
    """A surface turned outside, with at most two faces an edge, in one or few components.

    Left out, each with a note: vertices that are not finite, faces without an area or listed twice,
    the smallest faces at edges with more than two, and components below `KEPT` of the area. Faces
    are turned to agree with each other and to look away from the middle. With `need_texture`,
    texture coordinates in other tiles are wrapped.

    Raises `InputError`, which names the mesh and the fault, for a mesh without faces, with faces
    out of range, with more than `DAMAGED` broken, in pieces, or, with `need_texture`, without
    texture coordinates or a coloured texture.
    """
    _check_faces(mesh)
    notes: list[str] = []
    steps = [_finite, _solid, _unrepeated, _manifold, _largest, _agreeing, _outward]
    for repair in [*steps, _textured] if need_texture else steps:
        mesh, note = repair(mesh)
        notes += note
    return RepairedMesh(_compact(mesh), notes)


def guess_length_unit(
    vertices: Float[np.ndarray, "vertices 3"], name: str = "The mesh"
) -> LengthUnit:
    """The unit in which a mesh is as large as a face or a head, `FACE`.

    Raises `InputError` if it is in none of `UNITS`.
    """
    size = float(np.ptp(vertices, axis=0).max())
    for unit, millimetres in UNITS.items():
        length = size * millimetres
        if FACE[0] <= length <= FACE[1]:
            return LengthUnit(
                millimetres, f"{name} is taken to be in {unit}: it is {length:.0f} mm long."
            )
    raise InputError(
        f"{name} is {size:.3g} units long, which is no face or head of {FACE[0]:.0f} to "
        f"{FACE[1]:.0f} mm in {', '.join(UNITS)}; cut the face out, or say how many millimetres "
        "a unit is."
    )


def _check_faces(mesh: Mesh) -> None:
    if len(mesh.triangles) == 0:
        raise InputError(f"{mesh.name} has no faces; export it as a triangle mesh.")
    _check_range(mesh, mesh.triangles, len(mesh.vertices), "vertex")
    if mesh.uv is not None and mesh.uv_triangles is not None:
        _check_range(mesh, mesh.uv_triangles, len(mesh.uv), "texture coordinate")


def _check_range(mesh: Mesh, triangles: Int[np.ndarray, "t 3"], count: int, what: str) -> None:
    outside = triangles[(triangles < 0) | (triangles >= count)]
    if outside.size:
        raise InputError(
            f"{mesh.name} has a face with {what} {outside[0]}, and there are {count:,}; it is "
            "damaged or cut short, export it again."
        )


def _finite(mesh: Mesh) -> RepairedMesh:
    broken = ~np.isfinite(mesh.vertices).all(1)
    count = int(broken[np.unique(mesh.triangles)].sum())
    if count > DAMAGED * len(mesh.vertices):
        raise InputError(
            f"{mesh.name} is damaged: {count:,} of its {len(mesh.vertices):,} vertices are NaN or "
            "infinite; export it again."
        )
    note = f"{count:,} vertices that are NaN or infinite were left out with their faces."
    return _without(mesh, broken[mesh.triangles].any(1), note)


def _solid(mesh: Mesh) -> RepairedMesh:
    area = areas(mesh.vertices, mesh.triangles)
    flat = area <= 1e-12 * area.max()
    if flat.mean() > DAMAGED:
        raise InputError(
            f"{mesh.name} is damaged: {int(flat.sum()):,} of its {len(flat):,} faces have no area; "
            "export it again."
        )
    return _without(mesh, flat, f"{int(flat.sum()):,} faces without an area were left out.")


def _unrepeated(mesh: Mesh) -> RepairedMesh:
    _, first = np.unique(np.sort(mesh.triangles, 1), axis=0, return_index=True)
    again = np.ones(len(mesh.triangles), bool)
    again[first] = False
    return _without(mesh, again, f"{int(again.sum()):,} faces were listed twice.")


def _manifold(mesh: Mesh) -> RepairedMesh:
    """The two largest faces stay at every edge; what sticks to a surface is small."""
    area = areas(mesh.vertices, mesh.triangles)
    keys = edge_keys(half_edges(mesh.triangles), len(mesh.vertices))
    order = np.lexsort([-np.repeat(area, 3), keys])
    starts = np.flatnonzero(np.diff(keys[order], prepend=-1))
    count = np.diff(starts, append=len(keys))
    surplus = np.zeros(len(keys), bool)
    surplus[order] = np.arange(len(keys)) - np.repeat(starts, count) >= 2
    dropped = np.asarray(surplus.reshape(-1, 3).any(1))
    note = (
        f"{int((count > 2).sum()):,} edges had more than two faces (not manifold); the smallest "
        f"{int(dropped.sum()):,} faces there were left out."
    )
    return _without(mesh, dropped, note)


def _largest(mesh: Mesh) -> RepairedMesh:
    label = label_face_components(mesh.triangles)
    area = np.bincount(label, areas(mesh.vertices, mesh.triangles))
    share = area / area.sum()
    if share.max() < 0.5:
        raise InputError(
            f"{mesh.name} is in {len(share):,} pieces, the largest with {share.max():.0%} of the "
            "area; weld its vertices, or cut the face out."
        )
    dropped = share < KEPT
    note = (
        f"{int(dropped.sum()):,} of {len(share):,} components were left out, "
        f"{share[dropped].sum():.2%} of the area."
    )
    return _without(mesh, dropped[label], note)


def _agreeing(mesh: Mesh) -> RepairedMesh:
    turn = find_inconsistent_faces(mesh.vertices, mesh.triangles)
    note = f"{int(turn.sum()):,} faces were turned to agree with their neighbours."
    return _turned(mesh, turn, note)


def _outward(mesh: Mesh) -> RepairedMesh:
    turn = np.full(len(mesh.triangles), is_inside_out(mesh.vertices, mesh.triangles))
    return _turned(mesh, turn, "The faces looked inside, and all were turned.")


def _textured(mesh: Mesh) -> RepairedMesh:
    uv, triangles, texture = mesh.uv, mesh.uv_triangles, mesh.texture
    if uv is None or triangles is None:
        fault = "no texture coordinates (UV); export it with them, as OBJ or glTF"
    elif not np.isfinite(uv).all():
        fault = "texture coordinates that are NaN or infinite; export it again"
    elif texture is None:
        fault = (
            "no texture: its material names no picture that is there, and there is not one beside "
            "it; give the picture's path"
        )
    elif min(texture.shape[:2]) < PLACEHOLDER:
        size = f"{texture.shape[1]} x {texture.shape[0]}"
        fault = f"a texture of {size} pixels, a placeholder; give the picture's path"
    elif (texture == texture[..., :1]).all():
        fault = "a grey texture, and melanin and hemoglobin are read from colour; give another"
    else:
        return _tiled(mesh, uv, triangles)
    raise InputError(f"{mesh.name} has {fault}.")


def _tiled(
    mesh: Mesh, uv: Float[np.ndarray, "points 2"], triangles: Int[np.ndarray, "triangles 3"]
) -> RepairedMesh:
    corners = uv[triangles]
    outside = int(((corners < 0) | (corners > 1)).any((1, 2)).sum())
    if not outside:
        return RepairedMesh(mesh, [])
    placed = corners - np.floor(corners.mean(1, keepdims=True))
    jutting = int((np.abs(placed - 0.5) > 0.5 + JUTTING).any((1, 2)).sum())
    if jutting:
        raise InputError(
            f"{mesh.name} has {jutting:,} faces across the border of its texture (texture "
            f"coordinates {uv.min():.3g} to {uv.max():.3g}); unwrap it onto [0, 1]."
        )
    wrapped, moved = wrap_coordinates(uv, triangles)
    note = f"The texture was repeated for {outside:,} faces outside of it."
    return RepairedMesh(replace(mesh, uv=wrapped, uv_triangles=moved), [f"{mesh.name}: {note}"])


def _without(mesh: Mesh, dropped: Choice, note: str) -> RepairedMesh:
    if not dropped.any():
        return RepairedMesh(mesh, [])
    if dropped.all():
        raise InputError(f"{mesh.name} has no sound face; export it again.")
    uv_triangles = None if mesh.uv_triangles is None else mesh.uv_triangles[~dropped]
    kept = replace(mesh, triangles=mesh.triangles[~dropped], uv_triangles=uv_triangles)
    return RepairedMesh(kept, [f"{mesh.name}: {note}"])


def _turned(mesh: Mesh, turn: Choice, note: str) -> RepairedMesh:
    if not turn.any():
        return RepairedMesh(mesh, [])
    uv_triangles = None if mesh.uv_triangles is None else flip_triangles(mesh.uv_triangles, turn)
    triangles = flip_triangles(mesh.triangles, turn)
    return RepairedMesh(
        replace(mesh, triangles=triangles, uv_triangles=uv_triangles), [f"{mesh.name}: {note}"]
    )


def _compact(mesh: Mesh) -> Mesh:
    """Without vertices and texture coordinates that no face has."""
    used, place = np.unique(mesh.triangles, return_inverse=True)
    mesh = replace(mesh, vertices=mesh.vertices[used], triangles=place.reshape(-1, 3))
    if mesh.uv is None or mesh.uv_triangles is None:
        return mesh
    used, place = np.unique(mesh.uv_triangles, return_inverse=True)
    return replace(mesh, uv=mesh.uv[used], uv_triangles=place.reshape(-1, 3))
