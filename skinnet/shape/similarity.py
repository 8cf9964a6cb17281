"""Rotation, scale and translation between two sets of points."""

from typing import NamedTuple

import numpy as np
from jaxtyping import Float


class Similarity(NamedTuple):
    """x = scale * rotation @ v + translation."""

    rotation: Float[np.ndarray, "3 3"]
    scale: float
    translation: Float[np.ndarray, "3"]

    def __call__(self, points: Float[np.ndarray, "*points 3"]) -> Float[np.ndarray, "*points 3"]:
        """Points of the source in the target's frame."""
        return np.asarray(self.scale * points @ self.rotation.T + self.translation)

    def apply_inverse(
        self, points: Float[np.ndarray, "*points 3"]
    ) -> Float[np.ndarray, "*points 3"]:
        """Points of the target in the source's frame."""
        return np.asarray((points - self.translation) @ self.rotation / self.scale)


def fit_similarity(
    source: Float[np.ndarray, "points 3"],
    target: Float[np.ndarray, "points 3"],
    reflection: bool = False,
) -> Similarity:
    """Least-squares similarity from `source` to `target` (Umeyama 1991).

    With `reflection` the best mirroring one, whose `rotation` has determinant -1.
    """
    centre, goal = source.mean(0), target.mean(0)
    from_centre, from_goal = source - centre, target - goal
    left, singular, right = np.linalg.svd(from_goal.T @ from_centre)
    proper = np.linalg.det(left) * np.linalg.det(right) > 0
    signs = np.ones(3)
    if proper == reflection:
        signs[-1] = -1
    rotation = (left * signs) @ right
    scale = float((singular * signs).sum() / (from_centre**2).sum())
    return Similarity(rotation, scale, goal - scale * rotation @ centre)
