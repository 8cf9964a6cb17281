"""The colour space of a picture's pixels, and how it is known."""

from typing import NamedTuple


class ColourSpace(NamedTuple):
    """The colour space of a picture's pixels, and how it is known.

    Attributes:
        name: sRGB, Adobe RGB (1998), Display P3, or what the picture's profile calls itself.
        known_from: The statement that decided it: "ICC profile", "cICP chunk", "sRGB chunk", "gAMA
            and cHRM chunks", "EXIF", "TIFF tags", "nclx box", "colr box", "BMP header",
            "RAW development", "argument" for what was stated of an array, or "assumed".
        profile: ICC profile from these pixels; None for sRGB.

    Source:
        The order in which statements count is that of the PNG specification (third edition, section
        4.3) for PNG, and of ISO/IEC 23008-12 for HEIF and AVIF.

    Example:
        >>> from skimage.data import astronaut
        >>> from skinnet.images import read_picture
        >>> read_picture(astronaut()).colour_space.name
        'sRGB'
    """

    name: str
    known_from: str
    profile: bytes | None = None
