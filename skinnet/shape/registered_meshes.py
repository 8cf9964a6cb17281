"""A shape model from meshes in correspondence, by principal component analysis."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from jaxtyping import Float, Int

from skinnet.errors import InputError
from skinnet.mesh._mesh_parts import MeshPart, concatenate, read_obj_positions, read_parts
from skinnet.mesh._seams import match_positions, merge_coordinates
from skinnet.mesh._texture_atlas import pack_atlas
from skinnet.mesh._topology import weld
from skinnet.mesh.mesh import Mesh
from skinnet.mesh.repair import guess_length_unit
from skinnet.shape.model import ShapeModel
from skinnet.shape.similarity import fit_similarity

ROUNDS = 3
"""Rounds of alignment to the mean; the second already changes it by less than a thousandth."""

Faces = Float[np.ndarray, "subjects vertices 3"]
Vertices = Float[np.ndarray, "vertices 3"]
Triangles = Int[np.ndarray, "triangles 3"]
Coordinates = tuple[Float[np.ndarray, "points 2"] | None, Triangles | None]


def load_registered(
    files: Sequence[Path],
    modes: int | None = None,
    align: bool = True,
    millimetres: float | None = None,
    name: str = "model",
) -> ShapeModel:
    """A model of the meshes in these files (OBJ, PLY, glTF or STL), as `build_shape_model` makes it.

    Vertices are in the order of the first file, and those that coincide in every file are one.
    Raises `InputError` naming the file for one that cannot be read, or whose vertices or faces are
    not those of the first.
    """
    if not files:
        raise InputError(f"{name} has no meshes; give .obj, .ply, .glb or .gltf files.")
    read = [read_parts(Path(file)) for file in files]
    stacked = [concatenate([part.geometry for part in parts]) for parts in read]
    _check([(str(f), c.vertices, c.triangles) for f, c in zip(files, stacked, strict=True)])
    faces = np.stack([corners.vertices for corners in stacked])
    used, triangles = _joined(Path(files[0]), faces, stacked[0].triangles)
    uv, uv_triangles = _coordinates(read[0], triangles)
    first = Mesh(faces[0][used], triangles, uv, uv_triangles, name=str(files[0]))
    return _model(faces[:, used], first, modes, align, millimetres, name)


def build_shape_model(
    meshes: Sequence[Mesh],
    modes: int | None = None,
    align: bool = True,
    millimetres: float | None = None,
    name: str = "model",
) -> ShapeModel:
    """Mean and principal components of faces in correspondence; variances are those over them.

    With `align` every face is first laid on the mean by a rotation, a translation and a scale,
    since a fit finds these by itself; the mean keeps the subjects' average size and about the first
    one's frame, which should have x to the face's left, y up and z forward. `modes` is at most one
    less than the subjects, None for all with any variance. A unit is of `millimetres`, guessed
    from the size if None.

    Raises `InputError` naming the mesh whose vertices or faces are not those of the first, and for
    fewer subjects than the modes need.
    """
    if not meshes:
        raise InputError(f"{name} has no meshes; give at least two.")
    _check([(mesh.name, mesh.vertices, mesh.triangles) for mesh in meshes])
    faces = np.stack([mesh.vertices.astype(np.float64) for mesh in meshes])
    return _model(faces, meshes[0], modes, align, millimetres, name)


def _check(meshes: list[tuple[str, Vertices, Triangles]]) -> None:
    first, vertices, triangles = meshes[0]
    for name, each, _ in meshes:
        if not np.isfinite(each).all():
            raise InputError(f"{name} has vertices that are NaN or infinite; export it again.")
    for name, others, connected in meshes[1:]:
        if others.shape != vertices.shape:
            raise InputError(
                f"{name} has {len(others):,} vertices and {first} {len(vertices):,}; meshes of one "
                "model are in correspondence, vertex by vertex."
            )
        if not np.array_equal(connected, triangles):
            raise InputError(
                f"{name} and {first} have different faces; meshes of one model are in "
                "correspondence, vertex by vertex."
            )


def _joined(
    first: Path, faces: Faces, triangles: Triangles
) -> tuple[Int[np.ndarray, "vertices"], Triangles]:
    """Vertices at one place in the first face and in the mean made one, in the file's order."""
    places = [weld(faces[0]), weld(faces.mean(0)), np.zeros(faces.shape[1])]
    joint = weld(np.stack(places, 1).astype(np.float64))
    used, place = np.unique(joint[triangles], return_inverse=True)
    if first.suffix.lower() != ".obj":
        return used, place.reshape(-1, 3)
    order = np.argsort(match_positions(read_obj_positions(first), faces[0][used]), kind="stable")
    return used[order], np.argsort(order)[place].reshape(-1, 3)


def _coordinates(parts: list[MeshPart], triangles: Triangles) -> Coordinates:
    atlas = pack_atlas([part._replace(texture=None) for part in parts])
    if atlas is None:
        return None, None
    return merge_coordinates(triangles, atlas.uv, atlas.triangles)


def _model(
    faces: Faces,
    first: Mesh,
    modes: int | None,
    align: bool,
    millimetres: float | None,
    name: str,
) -> ShapeModel:
    if len(faces) < 2 or (modes is not None and modes >= len(faces)):
        raise InputError(
            f"{name}: {len(faces)} subjects give at most {len(faces) - 1} modes, and "
            f"{modes or 1} are asked for; ask for fewer, or give more subjects."
        )
    if align:
        faces = _aligned(faces)
    mean = faces.mean(0)
    basis, variances = _components((faces - mean).reshape(len(faces), -1))
    if not len(basis):
        raise InputError(f"{name}: all subjects have the same shape; give different ones.")
    model = ShapeModel(
        mean,
        basis.reshape(-1, *mean.shape),
        variances,
        first.triangles,
        first.uv,
        first.uv_triangles,
        millimetres=millimetres or guess_length_unit(mean, name).millimetres,
        name=name,
    )
    return model if modes is None else model.truncate(modes)


def _components(
    rows: Float[np.ndarray, "subjects numbers"],
) -> tuple[Float[np.ndarray, "modes numbers"], Float[np.ndarray, "modes"]]:
    """Orthonormal components and their variances, from the subjects' Gram matrix."""
    values, vectors = np.linalg.eigh(rows @ rows.T)
    order = np.flatnonzero(values > max(1e-12 * values[-1], 0))[::-1]
    basis = (vectors[:, order].T @ rows) / np.sqrt(values[order])[:, None]
    # The sign of an eigenvector is free: the largest number of a component is positive.
    peak = np.abs(basis).argmax(1)[:, None]
    return basis * np.sign(np.take_along_axis(basis, peak, 1)), values[order] / (len(rows) - 1)


def _aligned(faces: Faces) -> Faces:
    centred = faces - faces.mean(1, keepdims=True)
    size = np.sqrt(np.square(centred).sum((1, 2)).mean())
    mean = faces[0]
    for _ in range(ROUNDS):
        target = mean - mean.mean(0)
        target = target * size / np.linalg.norm(target) + mean.mean(0)
        faces = np.stack([fit_similarity(face, target)(face) for face in faces])
        mean = faces.mean(0)
    return faces
