"""From the values of a sensor to linear sRGB, as training renders pictures in linear light."""

from collections.abc import Sequence
from functools import cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from skinnet.images._raw.cameras import Camera, read_cameras

XYZ_TO_SRGB = np.linalg.inv(
    np.array(
        (
            (0.4123907993, 0.3575843394, 0.1804807884),
            (0.2126390059, 0.7151686788, 0.0721923154),
            (0.0193308187, 0.1191947798, 0.9505321522),
        )
    )
)
"""XYZ to linear sRGB, from the primaries of IEC 61966-2-1, not rounded."""

D65 = np.linalg.inv(XYZ_TO_SRGB).sum(1)
"""XYZ of white."""

_MEAN_STATED = np.array(
    ((1.701, -0.649, -0.052), (-0.158, 1.583, -0.425), (0.011, -0.445, 1.434)),
)
"""Mean of the matrices that LibRaw states of the measured cameras (`tools.bake_cameras`)."""

_TRUST = 0.3
"""Share of what a stated matrix differs from the mean one that the least-squares matrix does.

Of 48 measured cameras, each by the others, the error of R/G of pale to dark skin under D65, A and
LED-B3 was 3 to 6 % in the median and 9 to 12 % in the worst tenth; with the matrices as they are
stated, 6 to 11 and 15 to 22 %.
"""

_Matrix = NDArray[np.float64]


class StatedMatrix(NamedTuple):
    """The colours of a camera as its file or LibRaw states them.

    Attributes:
        matrix: From sensor values balanced under D65 to linear sRGB, [3, 3]; rows sum to 1.
        daylight: Sensor values [3] of white under D65, of any scale.
    """

    matrix: _Matrix
    daylight: NDArray[np.float64]


def read_stated_matrix(raw: Any, own: bool = False) -> StatedMatrix | None:
    """Read the colours that are stated of the camera of an open RAW file.

    Args:
        raw: A `rawpy.RawPy`.
        own: Whether to prefer the file's own matrix, which a DNG has, to that of LibRaw's table.

    Returns:
        The colours; None if they are not known.
    """
    from_file = np.asarray(raw.color_matrix, float)[:3, :3]
    gains = np.asarray(raw.daylight_whitebalance[:3], float)
    if own and _is_usable(from_file) and (gains > 0).all():
        return StatedMatrix(from_file, 1 / gains)
    to_sensor = np.asarray(raw.rgb_xyz_matrix, float)[:3, :3]
    if not _is_usable(to_sensor) or (daylight := to_sensor @ D65).min() <= 0:
        return None
    return StatedMatrix(XYZ_TO_SRGB @ np.linalg.inv(to_sensor) * daylight, daylight)


def choose_matrix(camera: Camera | None, stated: StatedMatrix | None) -> _Matrix | None:
    """Choose the matrix from values balanced under D65 to linear sRGB; None if none is known.

    That of a measured camera is the least-squares map of its sensitivities, as in training. Makers
    fit theirs to charts instead. So what a stated one tells is only how a camera differs from
    others.
    """
    if camera is not None:
        return camera.matrix
    if stated is None:
        return None
    chosen: _Matrix = _find_mean() + _TRUST * (stated.matrix - _MEAN_STATED)
    return chosen


def adapt_matrix(
    matrix: _Matrix, daylight: NDArray[np.float64], balance: Sequence[float]
) -> _Matrix:
    """Make the matrix from values that are balanced for the light of a photograph.

    As in training, XYZ of the light's white is scaled to that of D65.

    Args:
        matrix: From values balanced under D65 to linear sRGB.
        daylight: Sensor values of white under D65, [3].
        balance: Factors of R, G and B that make the light's white neutral.

    Returns:
        The matrix [3, 3], whose rows sum to 1; `matrix` itself if no light has this balance.
    """
    white = 1 / (np.asarray(balance) * daylight)
    white = white / white[1]
    to_xyz = np.linalg.inv(XYZ_TO_SRGB) @ matrix * white
    of_white = to_xyz.sum(1)
    if of_white.min() <= 0:
        return matrix
    adapted: _Matrix = XYZ_TO_SRGB @ (to_xyz * (D65 / of_white)[:, None])
    return adapted


@cache
def _find_mean() -> _Matrix:
    mean: _Matrix = np.mean([camera.matrix for camera in read_cameras()], 0)
    return mean


def _is_usable(matrix: _Matrix) -> bool:
    finite = bool(np.isfinite(matrix).all())
    return finite and bool(np.linalg.matrix_rank(matrix) == 3)
