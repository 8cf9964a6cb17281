"""Rotation, scale and translation between two sets of points."""

from typing import NamedTuple

import numpy as np
from jaxtyping import Float


class Similarity(NamedTuple):
    """A similarity transform: x = scale * rotation @ v + translation.

    Attributes:
        rotation: Orthogonal matrix; its determinant is -1 for a transform that mirrors.
        scale: Lengths in the target over lengths in the source, above 0.
        translation: The source's origin in the target's frame and unit.

    Example:
        >>> import numpy as np
        >>> from skinnet.shape import Similarity
        >>> pose = Similarity(np.eye(3), 2.0, np.array([1.0, 0.0, 0.0]))
        >>> pose(np.array([1.0, 1.0, 1.0]))
        array([3., 2., 2.])
    """

    rotation: Float[np.ndarray, "3 3"]
    scale: float
    translation: Float[np.ndarray, "3"]

    def __call__(self, points: Float[np.ndarray, "*points 3"]) -> Float[np.ndarray, "*points 3"]:
        """Transform points of the source into the target's frame.

        Args:
            points: Points in the source's frame and unit.

        Returns:
            The points in the target's frame and unit.
        """
        return np.asarray(self.scale * points @ self.rotation.T + self.translation)

    def apply_inverse(
        self, points: Float[np.ndarray, "*points 3"]
    ) -> Float[np.ndarray, "*points 3"]:
        """Transform points of the target into the source's frame.

        Args:
            points: Points in the target's frame and unit.

        Returns:
            The points in the source's frame and unit.
        """
        return np.asarray((points - self.translation) @ self.rotation / self.scale)


def fit_similarity(
    source: Float[np.ndarray, "points 3"],
    target: Float[np.ndarray, "points 3"],
    reflection: bool = False,
) -> Similarity:
    """Fit the least-squares similarity transform from one set of points to another.

    Args:
        source: Points, at least three that are not on a line.
        target: The corresponding points.
        reflection: Fit the best transform that mirrors, in place of the best that does not.

    Returns:
        The transform.

    Source:
        Umeyama 1991, equations 40 to 43.

    Example:
        >>> import numpy as np
        >>> from skinnet.shape import fit_similarity
        >>> source = np.eye(3)
        >>> round(fit_similarity(source, 5 * source + 1).scale, 6)
        5.0
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
