"""Repair of meshes: safe repairs are made and noted, any other fault is an error."""

from dataclasses import replace
from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float, Int

from skinnet.errors import InputError
from skinnet.images._colour_content import find_tone_of_texture
from skinnet.mesh._orientation import (
    compute_areas,
    find_inconsistent_faces,
    flip_triangles,
    is_inside_out,
    label_face_components,
)
from skinnet.mesh._texture_atlas import wrap_coordinates
from skinnet.mesh._topology import compute_edge_keys, list_half_edges
from skinnet.mesh.mesh import Mesh

DAMAGED = 0.1
"""Largest share of vertices that are not finite, or of faces without an area, in a usable mesh."""

KEPT = 0.1
"""Components with at least this share of the area are kept."""

PLACEHOLDER = 8
"""A texture with fewer texels than this on a side is a placeholder."""

OVERHANG = 0.01
"""Largest distance by which texture coordinates may leave their tile; they are clipped."""


_FaceMask = Bool[np.ndarray, "triangles"]


class RepairedMesh(NamedTuple):
    """A repaired mesh and what was changed.

    Attributes:
        mesh: The mesh.
        notes: A sentence for each change; empty if nothing was wrong.
    """

    mesh: Mesh
    notes: list[str]


def repair_mesh(mesh: Mesh, need_texture: bool = False) -> RepairedMesh:
    """Repair a mesh into an oriented manifold of one or few components.

    Vertices that are not finite, faces without an area, repeated faces, the smallest faces at edges
    with more than two, and components below `KEPT` of the area are removed. Faces are flipped so
    that neighbours are consistent and normals point outwards. With `need_texture`, texture
    coordinates outside [0, 1] are wrapped.

    Args:
        mesh: The mesh, with its name for messages.
        need_texture: Whether the mesh must have texture coordinates and a coloured texture.

    Returns:
        The repaired mesh and a note for each change.

    Raises:
        InputError: For a mesh without faces, with faces out of range, with more than `DAMAGED` of
            its vertices or faces broken, without a component of half of the area, or without the
            texture it needs.

    Example:
        >>> import numpy as np
        >>> from skinnet.mesh import Mesh, repair_mesh
        >>> vertices = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, -0.5]])
        >>> triangles = np.array([[0, 1, 2], [1, 3, 2], [2, 1, 3]])
        >>> repaired, notes = repair_mesh(Mesh(vertices, triangles, name="scan.obj"))
        >>> notes
        ['scan.obj: 1 repeated faces were removed.']
    """
    _check_faces(mesh)
    notes: list[str] = []
    steps = [
        _remove_infinite_vertices,
        _remove_flat_faces,
        _remove_repeated_faces,
        _remove_non_manifold_faces,
        _remove_small_components,
        _make_consistent,
        _orient_outward,
    ]
    for repair in [*steps, _check_texture] if need_texture else steps:
        mesh, note = repair(mesh)
        notes += note
    return RepairedMesh(_remove_unused(mesh), notes)


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


def _remove_infinite_vertices(mesh: Mesh) -> RepairedMesh:
    broken = ~np.isfinite(mesh.vertices).all(1)
    count = int(broken[np.unique(mesh.triangles)].sum())
    if count > DAMAGED * len(mesh.vertices):
        raise InputError(
            f"{mesh.name} is damaged: {count:,} of its {len(mesh.vertices):,} vertices are NaN or "
            "infinite; export it again."
        )
    note = f"{count:,} vertices that are NaN or infinite were removed with their faces."
    return _remove_faces(mesh, broken[mesh.triangles].any(1), note)


def _remove_flat_faces(mesh: Mesh) -> RepairedMesh:
    area = compute_areas(mesh.vertices, mesh.triangles)
    flat = area <= 1e-12 * area.max()
    if flat.mean() > DAMAGED:
        raise InputError(
            f"{mesh.name} is damaged: {int(flat.sum()):,} of its {len(flat):,} faces have no area; "
            "export it again."
        )
    return _remove_faces(mesh, flat, f"{int(flat.sum()):,} faces without an area were removed.")


def _remove_repeated_faces(mesh: Mesh) -> RepairedMesh:
    _, first = np.unique(np.sort(mesh.triangles, 1), axis=0, return_index=True)
    repeated = np.ones(len(mesh.triangles), bool)
    repeated[first] = False
    return _remove_faces(mesh, repeated, f"{int(repeated.sum()):,} repeated faces were removed.")


def _remove_non_manifold_faces(mesh: Mesh) -> RepairedMesh:
    """Keep the two largest faces at every edge; faces that do not belong there are small."""
    area = compute_areas(mesh.vertices, mesh.triangles)
    keys = compute_edge_keys(list_half_edges(mesh.triangles), len(mesh.vertices))
    order = np.lexsort([-np.repeat(area, 3), keys])
    starts = np.flatnonzero(np.diff(keys[order], prepend=-1))
    count = np.diff(starts, append=len(keys))
    surplus = np.zeros(len(keys), bool)
    surplus[order] = np.arange(len(keys)) - np.repeat(starts, count) >= 2
    removed = np.asarray(surplus.reshape(-1, 3).any(1))
    note = (
        f"{int((count > 2).sum()):,} edges had more than two faces (not manifold); the smallest "
        f"{int(removed.sum()):,} faces there were removed."
    )
    return _remove_faces(mesh, removed, note)


def _remove_small_components(mesh: Mesh) -> RepairedMesh:
    label = label_face_components(mesh.triangles)
    area = np.bincount(label, compute_areas(mesh.vertices, mesh.triangles))
    share = area / area.sum()
    if share.max() < 0.5:
        raise InputError(
            f"{mesh.name} is in {len(share):,} pieces, the largest with {share.max():.0%} of the "
            "area; weld its vertices, or cut the face out."
        )
    removed = share < KEPT
    note = (
        f"{int(removed.sum()):,} of {len(share):,} components were removed, "
        f"{share[removed].sum():.2%} of the area."
    )
    return _remove_faces(mesh, removed[label], note)


def _make_consistent(mesh: Mesh) -> RepairedMesh:
    flipped = find_inconsistent_faces(mesh.vertices, mesh.triangles)
    note = f"{int(flipped.sum()):,} faces were flipped to agree with their neighbours."
    return _flip_faces(mesh, flipped, note)


def _orient_outward(mesh: Mesh) -> RepairedMesh:
    flipped = np.full(len(mesh.triangles), is_inside_out(mesh.vertices, mesh.triangles))
    return _flip_faces(mesh, flipped, "The faces pointed inwards, and all were flipped.")


def _check_texture(mesh: Mesh) -> RepairedMesh:
    uv, triangles, texture = mesh.uv, mesh.uv_triangles, mesh.texture
    if uv is None or triangles is None:
        fault = "no texture coordinates (UV); export it with them, as OBJ or glTF"
    elif not np.isfinite(uv).all():
        fault = "texture coordinates that are NaN or infinite; export it again"
    elif texture is None:
        fault = (
            "no texture: its material names no picture, and none beside it has the mesh's name; "
            "give the picture with --texture"
        )
    elif min(texture.shape[:2]) < PLACEHOLDER:
        size = f"{texture.shape[1]} x {texture.shape[0]}"
        fault = f"a texture of {size} pixels, a placeholder; give the picture's path"
    elif (tone := find_tone_of_texture(texture)) is not None:
        fault = (
            f"a {tone} texture, without other colours; melanin and hemoglobin are read from "
            "colour, give another texture"
        )
    else:
        return _wrap_texture(mesh, uv, triangles)
    raise InputError(f"{mesh.name} has {fault}.")


def _wrap_texture(
    mesh: Mesh, uv: Float[np.ndarray, "points 2"], triangles: Int[np.ndarray, "triangles 3"]
) -> RepairedMesh:
    corners = uv[triangles]
    outside = int(((corners < 0) | (corners > 1)).any((1, 2)).sum())
    if not outside:
        return RepairedMesh(mesh, [])
    placed = corners - np.floor(corners.mean(1, keepdims=True))
    overhanging = int((np.abs(placed - 0.5) > 0.5 + OVERHANG).any((1, 2)).sum())
    if overhanging:
        raise InputError(
            f"{mesh.name} has {overhanging:,} faces across the border of its texture (texture "
            f"coordinates {uv.min():.3g} to {uv.max():.3g}); unwrap it onto [0, 1]."
        )
    wrapped, moved = wrap_coordinates(uv, triangles)
    note = f"{outside:,} faces outside the texture were wrapped onto it."
    return RepairedMesh(replace(mesh, uv=wrapped, uv_triangles=moved), [f"{mesh.name}: {note}"])


def _remove_faces(mesh: Mesh, removed: _FaceMask, note: str) -> RepairedMesh:
    if not removed.any():
        return RepairedMesh(mesh, [])
    if removed.all():
        raise InputError(f"{mesh.name} has only broken faces; export it again.")
    uv_triangles = None if mesh.uv_triangles is None else mesh.uv_triangles[~removed]
    kept = replace(mesh, triangles=mesh.triangles[~removed], uv_triangles=uv_triangles)
    return RepairedMesh(kept, [f"{mesh.name}: {note}"])


def _flip_faces(mesh: Mesh, flipped: _FaceMask, note: str) -> RepairedMesh:
    if not flipped.any():
        return RepairedMesh(mesh, [])
    uv_triangles = None if mesh.uv_triangles is None else flip_triangles(mesh.uv_triangles, flipped)
    triangles = flip_triangles(mesh.triangles, flipped)
    return RepairedMesh(
        replace(mesh, triangles=triangles, uv_triangles=uv_triangles), [f"{mesh.name}: {note}"]
    )


def _remove_unused(mesh: Mesh) -> Mesh:
    """Remove vertices and texture coordinates that no face uses."""
    used, place = np.unique(mesh.triangles, return_inverse=True)
    mesh = replace(mesh, vertices=mesh.vertices[used], triangles=place.reshape(-1, 3))
    if mesh.uv is None or mesh.uv_triangles is None:
        return mesh
    used, place = np.unique(mesh.uv_triangles, return_inverse=True)
    return replace(mesh, uv=mesh.uv[used], uv_triangles=place.reshape(-1, 3))
