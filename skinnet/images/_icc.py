"""ICC profiles: made from primaries, checked against pixels, and applied by Little CMS."""

import struct
from functools import cache
from io import BytesIO
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import DTypeLike, NDArray

from skinnet.files import READ_ERRORS

_CLASSES = ("mntr", "scnr", "prtr", "spac")
"""Classes of profiles that describe pixels; links, abstract and named-colour profiles do not."""

_CURVE_SAMPLES = 4096


class Primaries(NamedTuple):
    """Chromaticities (x, y) of a space's white and of its red, green and blue."""

    white: tuple[float, float]
    red: tuple[float, float]
    green: tuple[float, float]
    blue: tuple[float, float]


def convert_pixels(
    pixels: NDArray[Any], source: bytes, target: bytes, dtype: DTypeLike
) -> NDArray[Any]:
    """Convert [H, W] grey, [H, W, 3] RGB or [H, W, 4] CMYK to another profile.

    Colours are relative to white, and black is mapped to black. Integers are of full range; floats
    are in units of white, and are not clipped.
    """
    from imagecodecs import CMS, cms_transform

    converted: NDArray[Any] = cms_transform(
        np.ascontiguousarray(pixels),
        source,
        target,
        colorspace=_describe_channels(pixels.shape[2:]),
        outcolorspace={"RGB": "rgb", "GRAY": "gray", "CMYK": "cmyk"}[read_signature(target, 16)],
        outdtype=np.dtype(dtype),
        intent=CMS.INTENT.RELATIVE_COLORIMETRIC,
        flags=CMS.FLAGS.BLACKPOINTCOMPENSATION,
    )
    return converted


SRGB_PRIMARIES = Primaries((0.3127, 0.3290), (0.64, 0.33), (0.30, 0.60), (0.15, 0.06))
"""ITU-R BT.709 with the white of D65."""


@cache
def make_srgb_profile() -> bytes:
    """The profile of sRGB."""
    from imagecodecs import cms_profile

    return bytes(cms_profile("srgb"))


@cache
def make_linear_profile() -> bytes:
    """The profile of linear sRGB."""
    return make_profile(SRGB_PRIMARIES, 1.0)


@cache
def make_profile(primaries: Primaries, curve: float | tuple[float, ...]) -> bytes:
    """Make the profile of an RGB space.

    Args:
        primaries: Chromaticities of white and primaries.
        curve: Exponent from pixels to linear light, or linear light at equal steps of the pixels.
    """
    from imagecodecs import cms_profile

    gamma = curve if isinstance(curve, float) else None
    table = None if isinstance(curve, float) else np.array(curve, np.float32)
    profile = cms_profile(
        "rgb",
        whitepoint=[*primaries.white, 1.0],
        primaries=[value for pair in primaries[1:] for value in pair],
        gamma=gamma,
        transferfunction=table,
    )
    return bytes(profile)


def sample_curve(decode: Any) -> tuple[float, ...]:
    """Linear light at equal steps of the pixels, from a function of pixels in [0, 1]."""
    values = decode(np.linspace(0, 1, _CURVE_SAMPLES))
    return tuple(np.asarray(values, float).tolist())


def read_signature(profile: bytes, offset: int) -> str:
    """Read one of the four-letter words in a profile's header."""
    return profile[offset : offset + 4].decode("latin-1").strip()


def describe_profile(profile: bytes) -> str:
    """The name that a profile gives itself."""
    from PIL import ImageCms

    try:
        parsed = ImageCms.ImageCmsProfile(BytesIO(profile))
        return " ".join(ImageCms.getProfileDescription(parsed).split()) or "unnamed"
    except (ImageCms.PyCMSError, *READ_ERRORS):
        return "unnamed"


def read_code_points(profile: bytes) -> tuple[int, int] | None:
    """Primaries and transfer of a profile's cicp tag (ICC.1:2022), or None."""
    try:
        count = struct.unpack_from(">I", profile, 128)[0]
        for number in range(min(count, 100)):
            tag, offset, _ = struct.unpack_from(">4sII", profile, 132 + 12 * number)
            if tag == b"cicp":
                return profile[offset + 8], profile[offset + 9]
    except (struct.error, IndexError):
        pass
    return None


def fits_pixels(profile: bytes, channels: str) -> bool:
    """Whether a profile can be applied to pixels of these channels: RGB, GRAY or CMYK."""
    if read_signature(profile, 16) != channels or read_signature(profile, 12) not in _CLASSES:
        return False
    shape = {"RGB": (1, 1, 3), "GRAY": (1, 1), "CMYK": (1, 1, 4)}[channels]
    try:
        convert_pixels(np.zeros(shape, np.uint8), profile, make_srgb_profile(), np.uint8)
    except READ_ERRORS:  # CmsError is a RuntimeError
        return False
    return True


def _describe_channels(channels: tuple[int, ...]) -> str:
    return {(): "gray", (3,): "rgb", (4,): "cmyk"}[channels]
