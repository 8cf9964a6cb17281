"""Write small RAW files (DNG) of known sensor values, for tests and for questions to LibRaw."""

from collections.abc import Sequence
from io import BytesIO
from typing import Any, NamedTuple

import numpy as np
import tifffile
from numpy.typing import NDArray

BLACK, WHITE = 512, 16383
"""Stored values of no light and of a full sensor."""

_CFA, _D65 = 32803, 21
_SHORT, _LONG, _RATIONAL, _SIGNED_RATIONAL, _BYTE, _ASCII = 3, 4, 5, 10, 1, 2
_DENOMINATOR = 10**6


class Sensor(NamedTuple):
    """What a DNG states of its camera.

    Attributes:
        make: Maker, as EXIF writes it.
        model: Model, as EXIF writes it.
        neutral: Sensor values [3] of white in the light, of any scale; None: not stated.
        matrix: From XYZ to sensor values under D65, [3, 3]; None: not stated.
        orientation: That of EXIF.
        exif: Further tags of the first directory, as tifffile takes them.
    """

    make: str = "Acme"
    model: str = "One"
    neutral: Sequence[float] | None = (1.0, 1.0, 1.0)
    matrix: NDArray[np.float64] | None = None
    orientation: int = 1
    exif: tuple[tuple[Any, ...], ...] = ()


def write_dng(values: NDArray[Any], sensor: Sensor, **options: Any) -> bytes:
    """Write the values of a sensor as a DNG with a Bayer mosaic.

    Args:
        values: R, G and B [H, W, 3] in [0, 1], of which each pixel keeps one.
        sensor: What the file states of its camera.
        options: Further arguments of `tifffile.imwrite`, such as `compression`.

    Returns:
        The content of the file.
    """
    stored = np.rint(BLACK + np.clip(values, 0, 1) * (WHITE - BLACK)).astype(np.uint16)
    mosaic = stored[..., 1].copy()
    mosaic[::2, ::2], mosaic[1::2, 1::2] = stored[::2, ::2, 0], stored[1::2, 1::2, 2]
    file = BytesIO()
    tags = sorted((*_list_tags(sensor), *sensor.exif))
    tifffile.imwrite(
        file, mosaic, photometric=_CFA, extratags=tags, metadata=None, software=False, **options
    )
    return file.getvalue()


def _list_tags(sensor: Sensor) -> list[tuple[Any, ...]]:
    tags: list[tuple[Any, ...]] = [
        (271, _ASCII, None, sensor.make, True),
        (272, _ASCII, None, sensor.model, True),
        (274, _SHORT, 1, sensor.orientation, True),
        (33421, _SHORT, 2, (2, 2), True),  # the mosaic repeats after two pixels:
        (33422, _BYTE, 4, bytes([0, 1, 1, 2]), True),  # R G, G B
        (50706, _BYTE, 4, bytes([1, 4, 0, 0]), True),
        (50707, _BYTE, 4, bytes([1, 1, 0, 0]), True),
        (50708, _ASCII, None, f"{sensor.make} {sensor.model}", True),
        (50714, _SHORT, 1, BLACK, True),
        (50717, _LONG, 1, WHITE, True),
    ]
    if sensor.matrix is not None:
        tags.append((50721, _SIGNED_RATIONAL, 9, _as_fractions(sensor.matrix.ravel()), True))
        tags.append((50778, _SHORT, 1, _D65, True))
    if sensor.neutral is not None:
        tags.append((50728, _RATIONAL, 3, _as_fractions(sensor.neutral), True))
    return tags


def _as_fractions(values: Sequence[float] | NDArray[np.float64]) -> tuple[int, ...]:
    return tuple(part for one in values for part in (round(one * _DENOMINATOR), _DENOMINATOR))
