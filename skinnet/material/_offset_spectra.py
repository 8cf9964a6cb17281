"""Spectra for what the pigments do not explain: the colour offset of the paper's section 4.4."""

import numpy as np
from jaxtyping import Float

_LEVEL = 1e-6
"""Weight of a spectrum's size beside its roughness; it makes the solution unique."""


def compute_offset_spectra(
    matrix: Float[np.ndarray, "wavelength 3"],
) -> Float[np.ndarray, "3 wavelength"]:
    """Compute the smoothest spectra whose colours are (1, 0, 0), (0, 1, 0) and (0, 0, 1).

    An offset is a colour under one light and camera. To be seen under another light it needs a
    spectrum. Of the many that have its colour the smoothest is taken: the one with the least sum of
    squared second differences. It is linear in the offset, so three spectra give all others.

    Args:
        matrix: Maps a spectrum to linear RGB under the light and camera of the offset.

    Returns:
        The spectra; an offset times them has that offset as its colour under the matrix.

    Example:
        >>> import numpy as np
        >>> matrix = np.eye(33)[:, [25, 15, 5]]
        >>> np.round(compute_offset_spectra(matrix) @ matrix, 6)
        array([[ 1.,  0.,  0.],
               [-0.,  1.,  0.],
               [ 0., -0.,  1.]])
    """
    bands = len(matrix)
    differences = np.diff(np.eye(bands), 2, axis=0)
    roughness = differences.T @ differences + _LEVEL * np.eye(bands)
    smoothed = np.linalg.solve(roughness, matrix)
    return np.linalg.solve(matrix.T @ smoothed, smoothed.T)
