"""A shape model from meshes in correspondence, by principal component analysis."""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float

from skinnet.errors import InputError
from skinnet.mesh._length_unit import guess_length_unit
from skinnet.mesh.mesh import Mesh
from skinnet.shape.model import ShapeModel
from skinnet.shape.similarity import fit_similarity

ROUNDS = 3
"""Rounds of alignment to the mean; the second already changes it by less than a thousandth."""


def build_shape_model(
    meshes: Sequence[Mesh],
    modes: int | None = None,
    align: bool = True,
    millimetres: float | None = None,
    name: str = "model",
) -> ShapeModel:
    """Build a shape model from registered meshes by principal component analysis.

    Args:
        meshes: Faces of different people with the same triangles, x to the face's left, y up and z
            forward. Texture coordinates are those of the first.
        modes: Number of modes, at most one less than the meshes; None for all with any variance.
        align: Align every face to the mean by rotation, translation and scale (Procrustes
            analysis), since a fit finds these by itself. The mean keeps the average size, and
            nearly the pose of the first face.
        millimetres: Length of the meshes' unit in mm, guessed from their size if None.
        name: What error messages call the model.

    Returns:
        The model, with orthonormal modes in the order of their variances.

    Raises:
        InputError: If a mesh does not correspond to the first, there are too few meshes for the
            modes, or all meshes have the same shape.

    Example:
        >>> import numpy as np
        >>> from skinnet.mesh import Mesh
        >>> from skinnet.shape import build_shape_model
        >>> corners = np.array([[-70.0, 0, 0], [70, 0, 0], [0, 180, 0]])
        >>> people = [Mesh(corners * [1, 1 + k / 50, 1], np.array([[0, 1, 2]])) for k in range(3)]
        >>> model = build_shape_model(people, align=False)
        >>> model.variances.round(2)
        array([12.96])
    """
    if not meshes:
        raise InputError(f"{name} has no meshes; give at least two.")
    _check_correspondence(meshes)
    if len(meshes) < 2 or (modes is not None and modes >= len(meshes)):
        raise InputError(
            f"{name}: {len(meshes)} subjects give at most {len(meshes) - 1} modes, and "
            f"{modes or 1} are asked for; ask for fewer, or give more subjects."
        )
    faces = np.stack([np.asarray(mesh.vertices, np.float64) for mesh in meshes])
    if align:
        faces = _align(faces)
    mean = faces.mean(0)
    basis, variances = _find_components((faces - mean).reshape(len(faces), -1))
    if not len(basis):
        raise InputError(f"{name}: all subjects have the same shape; give different ones.")
    first = meshes[0]
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


def _check_correspondence(meshes: Sequence[Mesh]) -> None:
    first = meshes[0]
    for mesh in meshes:
        if not np.isfinite(mesh.vertices).all():
            raise InputError(f"{mesh.name} has vertices that are NaN or infinite; export it again.")
    for mesh in meshes[1:]:
        if mesh.vertices.shape != first.vertices.shape:
            raise InputError(
                f"{mesh.name} has {len(mesh.vertices):,} vertices and {first.name} "
                f"{len(first.vertices):,}; meshes of one model are in correspondence, vertex by "
                "vertex."
            )
        if not np.array_equal(mesh.triangles, first.triangles):
            raise InputError(
                f"{mesh.name} and {first.name} have different faces; meshes of one model are in "
                "correspondence, vertex by vertex."
            )


def _find_components(
    rows: Float[np.ndarray, "subjects numbers"],
) -> tuple[Float[np.ndarray, "modes numbers"], Float[np.ndarray, "modes"]]:
    """Find orthonormal components and their variances, from the subjects' Gram matrix."""
    values, vectors = np.linalg.eigh(rows @ rows.T)
    order = np.flatnonzero(values > max(1e-12 * values[-1], 0))[::-1]
    basis = (vectors[:, order].T @ rows) / np.sqrt(values[order])[:, None]
    # The sign of an eigenvector is free: the largest number of a component is positive.
    peak = np.abs(basis).argmax(1)[:, None]
    return basis * np.sign(np.take_along_axis(basis, peak, 1)), values[order] / (len(rows) - 1)


def _align(
    faces: Float[np.ndarray, "subjects vertices 3"],
) -> Float[np.ndarray, "subjects vertices 3"]:
    centred = faces - faces.mean(1, keepdims=True)
    size = np.sqrt(np.square(centred).sum((1, 2)).mean())
    mean = faces[0]
    for _ in range(ROUNDS):
        target = mean - mean.mean(0)
        target = target * size / np.linalg.norm(target) + mean.mean(0)
        faces = np.stack([fit_similarity(face, target)(face) for face in faces])
        mean = faces.mean(0)
    return faces
