"""The camera and its exposure, as EXIF states them."""

import math
from typing import NamedTuple

from PIL import Image

from skinnet.files import READ_ERRORS
from skinnet.images.picture import Picture

_MODEL, _EXIF, _TIME, _APERTURE, _SENSITIVITY = 0x0110, 0x8769, 0x829A, 0x829D, 0x8827


class ShotSettings(NamedTuple):
    """What EXIF states; None is what it does not.

    Attributes:
        camera: The camera's model.
        exposure_value: Base 2 logarithm of time * sensitivity / aperture^2: how bright the camera
            makes a scene.
    """

    camera: str | None = None
    exposure_value: float | None = None


def read_settings(picture: Picture) -> ShotSettings:
    """Read the settings of a picture's camera."""
    block = picture.metadata.get("exif", b"")
    exif = Image.Exif()
    try:
        exif.load(block)
        inner = exif.get_ifd(_EXIF)
        camera = str(exif.get(_MODEL) or "").strip("\0 ") or None
        numbers = [inner.get(tag) for tag in (_TIME, _SENSITIVITY, _APERTURE)]
        time, sensitivity, aperture = (_read_number(number) for number in numbers)
    except READ_ERRORS:
        return ShotSettings()
    if time is None or sensitivity is None or aperture is None:
        return ShotSettings(camera)
    return ShotSettings(camera, round(math.log2(time * sensitivity / aperture**2), 3))


def _read_number(value: object) -> float | None:
    """A positive number; of several, the first."""
    first = value[0] if isinstance(value, tuple) and value else value
    try:
        number = float(first)  # type: ignore[arg-type]
    except (TypeError, ValueError, ZeroDivisionError):
        return None
    return number if math.isfinite(number) and number > 0 else None
