"""Whether the landmarks of a scan can start a fit."""

from collections.abc import Mapping

import numpy as np
from jaxtyping import Float
from scipy.spatial import cKDTree

from skinnet.errors import InputError
from skinnet.mesh.mesh import Mesh
from skinnet.shape.model import ShapeModel
from skinnet.shape.similarity import fit_similarity

MIN_COUNT = 4
"""A fit needs at least this many landmarks in common with its model."""

MAX_DISTANCE = 0.1
"""Largest distance of a landmark from the mesh, in lengths of the mesh."""

MIRRORED_RATIO = 0.2
"""Squared residual of the best reflection over that of the best rotation; below this, left and
right are swapped. It is above 5 for real and synthetic faces, below 0.2 for swapped ones, and near
1 for points in a plane."""


def check_landmarks(
    points: Mapping[str, Float[np.ndarray, "3"]],
    model: ShapeModel,
    mesh: Mesh | None = None,
    name: str = "The landmarks",
) -> list[str]:
    """Check that the landmarks of a scan can start a fit.

    Args:
        points: Points of the scan by name.
        model: The shape model, whose landmarks have the same names.
        mesh: The scan; None to skip the distance check.
        name: What error messages call the points.

    Returns:
        Names that scan and model have in common, in the model's order.

    Raises:
        InputError: If fewer than four names are common, or points are not finite, lie on a line,
            are far from the mesh, or fit the model's mirror image better than the model.

    Example:
        >>> from skinnet.shape._landmark_check import check_landmarks
        >>> from skinnet.shape import load_shape_model
        >>> model = load_shape_model()
        >>> points = {name: model.mean[vertex] for name, vertex in model.landmarks.items()}
        >>> len(check_landmarks(points, model))
        20
    """
    if not model.landmarks:
        raise InputError(
            f"{model.name} has no landmarks; give a .json file of names and vertex numbers."
        )
    common = [each for each in model.landmarks if each in points]
    if len(common) < MIN_COUNT:
        missing = ", ".join(each for each in model.landmarks if each not in points)
        raise InputError(
            f"{name}: {len(common)} of the model's {len(model.landmarks)} are there, and at least "
            f"{MIN_COUNT} are needed; missing are {missing}."
        )
    target = np.stack([points[each] for each in common]).astype(np.float64)
    bad = [each for each, point in zip(common, target, strict=True) if not np.isfinite(point).all()]
    if bad:
        raise InputError(f"{name}: {', '.join(bad)} are not finite numbers; mark them again.")
    if mesh is not None:
        _check_near(common, target, mesh, name)
    source = model.mean[[model.landmarks[each] for each in common]].astype(np.float64)
    _check_side(source, target, name)
    return common


def _check_near(
    names: list[str], points: Float[np.ndarray, "points 3"], mesh: Mesh, name: str
) -> None:
    length = float(np.ptp(mesh.vertices, axis=0).max())
    distance = np.asarray(cKDTree(mesh.vertices).query(points)[0]) / length
    worst = int(distance.argmax())
    if distance[worst] > MAX_DISTANCE:
        raise InputError(
            f"{name}: {names[worst]} is {distance[worst]:.2g} times the length of {mesh.name} away "
            "from it; are they in the same unit and frame?"
        )


def _check_side(
    source: Float[np.ndarray, "points 3"], target: Float[np.ndarray, "points 3"], name: str
) -> None:
    spread = np.linalg.svd(target - target.mean(0), compute_uv=False)
    if spread[1] <= 1e-3 * spread[0]:
        raise InputError(f"{name} lie on a line, or all in one place; mark them on the face.")
    residual, mirrored = (
        float(np.square(fit_similarity(source, target, reflection)(source) - target).sum())
        for reflection in (False, True)
    )
    if mirrored + 1e-9 * spread[0] ** 2 < MIRRORED_RATIO * residual:
        raise InputError(f"{name} appear mirrored; swap left and right.")
