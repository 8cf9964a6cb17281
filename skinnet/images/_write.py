"""Pictures to files of any format, and in words what a format cannot hold."""

import warnings
from collections.abc import Callable
from dataclasses import replace
from importlib.util import find_spec
from pathlib import Path
from typing import NamedTuple

import numpy as np

from skinnet.errors import InputError, _explain_fault
from skinnet.files import READ_ERRORS, write_atomically
from skinnet.images import _writers as writers
from skinnet.images._carried import Carried, carry
from skinnet.images._exif import update_exif
from skinnet.images._fit import blend_with_white, convert_to_srgb, reduce_depth
from skinnet.images._jp2_writer import write_jp2
from skinnet.images._mark import Mark
from skinnet.images._png_writer import write_png_picture
from skinnet.images._segments import EXIF_PREFIX, LARGEST, XMP_PREFIX
from skinnet.images._tiff_writer import write_tiff
from skinnet.images.picture import Picture

ALPHA, DEEP, CMYK, PROFILE = "transparency", "16 bits a channel", "CMYK", "a colour profile"
EXIF, XMP, PHOTOSHOP, TEXT, COMMENT, DPI = "EXIF", "XMP", "IPTC", "texts", "the comment", "the dpi"

_ANY_NAME = frozenset({ALPHA, PROFILE, EXIF, XMP})
_IN_EXIF = frozenset({"mark", "dpi"})
_WORDS = {PHOTOSHOP: "IPTC and other image resources", DPI: "the resolution (dpi)"}


class Format(NamedTuple):
    """A format of files: its name, its suffixes, what it holds, and its writer.

    `in_exif` is what it can state by EXIF alone: `mark`, `dpi`. `is_lossy` says whether its writer
    takes a quality.
    """

    name: str
    suffixes: tuple[str, ...]
    holds: frozenset[str]
    write: Callable[..., None]
    in_exif: frozenset[str] = frozenset()
    is_lossy: bool = False


_JPEG = Format(
    "JPEG",
    (".jpg", ".jpeg", ".jpe", ".jfif", ".jfi", ".jif", ".pjpeg", ".pjp"),
    frozenset({CMYK, PROFILE, EXIF, XMP, PHOTOSHOP, COMMENT, DPI}),
    writers.write_jpeg,
    frozenset({"mark"}),
    is_lossy=True,
)
_PNG = Format(
    "PNG",
    (".png",),
    frozenset({ALPHA, DEEP, PROFILE, EXIF, XMP, TEXT, COMMENT, DPI}),
    write_png_picture,
)
_TIFF = Format(
    "TIFF",
    (".tif", ".tiff"),
    frozenset({ALPHA, DEEP, CMYK, PROFILE, EXIF, XMP, PHOTOSHOP, DPI}),
    write_tiff,
    frozenset({"mark"}),
)
_WEBP = Format("WebP", (".webp",), _ANY_NAME, writers.write_webp, _IN_EXIF, True)
_AVIF = Format("AVIF", (".avif",), _ANY_NAME, writers.write_avif, _IN_EXIF, True)
_HEIF = Format("HEIC", (".heic", ".heif", ".hif"), _ANY_NAME, writers.write_heif, _IN_EXIF, True)
_BMP = Format("BMP", (".bmp", ".dib"), frozenset({DPI}), writers.write_bmp)
_JP2 = Format("JPEG 2000", (".jp2",), frozenset({ALPHA, DEEP, PROFILE, EXIF, XMP, DPI}), write_jp2)
_PPM = Format("PPM", (".ppm", ".pnm"), frozenset({DEEP}), writers.write_ppm)
_FORMATS = {
    "JPEG": _JPEG,
    "MPO": _JPEG,
    "PNG": _PNG,
    "TIFF": _TIFF,
    "WEBP": _WEBP,
    "AVIF": _AVIF,
    "HEIF": _HEIF,
    "JPEG2000": _JP2,
    "BMP": _BMP,
    "PPM": _PPM,
}
"""Formats that are written, by Pillow's names."""

_REASONS = {"GIF": "GIF holds 256 colours only", "RAW": "RAW files are only read"}


def choose_suffix(picture: Picture, suffix: str) -> tuple[str, tuple[str, ...]]:
    """Choose the suffix of an edited photograph, so that it keeps its format.

    Args:
        picture: The photograph.
        suffix: Its own suffix, which stays if it is one of its format.

    Returns:
        The suffix, and a note if the format is another one.
    """
    wanted = _FORMATS.get(picture.format)
    if wanted is not None and _list_needs(picture) <= wanted.holds:
        return (suffix if suffix.lower() in wanted.suffixes else wanted.suffixes[0]), ()
    if not picture.format:
        return ".png", ()
    reason = _REASONS.get(picture.format, f"{picture.format} does not hold all that it has")
    return ".png", (f"The edit of {picture.name} is written as PNG, since {reason}.",)


def _list_needs(picture: Picture) -> frozenset[str]:
    needs = {
        ALPHA: picture.alpha is not None,
        DEEP: picture.pixels.dtype.itemsize == 2,
        CMYK: picture.pixels.shape[2:] == (4,),
        PROFILE: picture.colour_space.profile is not None,
    }
    return frozenset(need for need, there in needs.items() if there)


def has_format(suffix: str) -> bool:
    """Whether a suffix is one of a format that is written."""
    return any(suffix.lower() in each.suffixes for each in _FORMATS.values())


def find_format(path: Path) -> Format:
    """Find the format that a file's suffix asks for.

    Raises:
        InputError: There is none, or it needs an extra.
    """
    known = {suffix: each for each in _FORMATS.values() for suffix in each.suffixes}
    found = known.get(path.suffix.lower())
    if found is None:
        usual = ", ".join(dict.fromkeys(each.suffixes[0] for each in _FORMATS.values()))
        raise InputError(f"{path} has to end in {usual}; got {path.suffix!r}.")
    if found is _HEIF and find_spec("pillow_heif") is None:
        raise InputError(
            f'{path} would be a HEIC picture, which needs an extra: pip install "skinnet[heif]"; '
            "or choose another format."
        )
    return found


def check_quality(quality: int) -> None:
    """Refuse a quality that no format has.

    Raises:
        InputError: It is outside 1 to 100.
    """
    if not 1 <= quality <= 100:
        raise InputError(
            f"The quality is a number from 1 to 100; got {quality}. 95 is high, 75 is usual for "
            "the web; without one the edit is as good as its photograph."
        )


def write_picture(
    path: Path,
    picture: Picture,
    mark: Mark | None = None,
    quality: int | None = None,
    name: str = "",
) -> tuple[str, ...]:
    """Write a picture with everything that it carries, completely or not at all.

    Args:
        path: The file; its suffix chooses the format.
        picture: The picture, turned upright.
        mark: What the file says of its making.
        quality: Quality from 1 to 100 for formats with loss; None for that of the original, where
            it is known, and else for 95, or WebP without loss.
        name: What messages call the file; its path by default.

    Returns:
        A sentence for each thing that the format cannot hold, and that is lost.

    Raises:
        InputError: The suffix is of no known format, or the file cannot be written.
    """
    target, name = find_format(path), name or str(path)
    fitted, notes = _fit_pixels(picture.as_colour(), target, name)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # Pillow warns of odd metadata
        carried = carry(fitted, mark, target.in_exif, str(path))
    carried, lost = _fit_metadata(carried, target)
    lost += _list_left(picture, target)
    if lost:
        words = ", ".join(dict.fromkeys(lost))
        notes.append(f"{name} is without these parts of {picture.name}: {words}.")
    if quality is not None and not target.is_lossy:
        notes.append(f"{name} is written without loss: {target.name} has no quality.")
    options = {} if quality is None or not target.is_lossy else {"quality": quality}
    try:
        with write_atomically(path) as part:
            target.write(part, fitted, carried, **options)
    except InputError:
        raise
    except READ_ERRORS as error:  # encoders refuse by many of them, such as sizes above a limit
        fault = error if isinstance(error, OSError) else OSError(str(error))
        explained = _explain_fault(fault, "choose another file with -o")
        raise InputError(f"{name} cannot be written {explained}.") from error
    return tuple(notes)


def _fit_pixels(picture: Picture, target: Format, name: str) -> tuple[Picture, list[str]]:
    """Pixels that a format can hold, and sentences on what that costs."""
    notes = []
    if picture.pixels.shape[2] == 4 and CMYK not in target.holds:
        notes.append(f"{name} is converted to sRGB, since {target.name} holds no CMYK.")
        picture = convert_to_srgb(picture)
    if picture.colour_space.profile and PROFILE not in target.holds:
        space = picture.colour_space.name
        reason = f"since {target.name} holds no colour profile"
        notes.append(f"{name} is converted from {space} to sRGB, {reason}.")
        picture = convert_to_srgb(picture)
    if picture.alpha is not None and ALPHA not in target.holds:
        if (picture.alpha < np.iinfo(picture.alpha.dtype).max).any():
            words = f"since {target.name} holds no transparency"
            notes.append(f"{name} is blended with white, {words}.")
        picture = blend_with_white(picture)
    if picture.pixels.dtype.itemsize == 2 and DEEP not in target.holds:
        notes.append(f"{name} has 8 bits a channel, since {target.name} holds no 16.")
        picture = reduce_depth(picture)
    return picture, notes


def _fit_metadata(carried: Carried, target: Format) -> tuple[Carried, list[str]]:
    """Metadata that a format can hold, and the names of the rest."""
    lost = [*carried.problems]
    if EXIF not in target.holds:
        lost += [EXIF] * bool(carried.own.get("exif"))
        carried = replace(carried, exif=b"")
    if XMP not in target.holds:
        lost += [XMP] * bool(carried.xmp)
        carried = replace(carried, xmp=b"")
    if target is _JPEG and len(EXIF_PREFIX + carried.exif) > LARGEST:
        lost.append("EXIF of more than 64 KB")
        carried = replace(carried, exif=update_exif(b"", (0, 0), str(carried.mark or "")))
    if target is _JPEG and len(XMP_PREFIX + carried.xmp) > LARGEST:
        lost.append("XMP of more than 64 KB")
        carried = replace(carried, xmp=b"")
    values = {PHOTOSHOP: carried.photoshop, COMMENT: carried.comment, DPI: carried.dpi}
    for name, value in values.items():
        if value and name not in target.holds and not (name == DPI and "dpi" in target.in_exif):
            lost.append(_WORDS.get(name, name))
    if carried.text and TEXT not in target.holds:
        lost.append(f"texts ({', '.join(carried.text)})")
    return carried, lost


def _list_left(picture: Picture, target: Format) -> list[str]:
    """What lies beside the picture in its file, and is of the photograph before the edit."""
    lost = list(picture.metadata.get("companions", ()))
    frames = picture.metadata.get("frames", 1)
    if frames > 1:
        lost.append(f"{frames - 1} further picture{'s' if frames > 2 else ''}")
    return lost
