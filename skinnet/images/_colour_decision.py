"""The one decision on the colour space of a picture, from everything that its file states."""

from pathlib import PurePath
from typing import NamedTuple

from PIL import Image

from skinnet.errors import InputError
from skinnet.images._icc import describe_profile, fits_pixels, read_code_points
from skinnet.images._named_spaces import (
    ADOBE_RGB,
    DISPLAY_P3,
    HDR_TRANSFERS,
    SRGB,
    WIDE_GAMUT_RGB,
    NamedSpace,
    find_coded_space,
    find_space,
)
from skinnet.images._statements import (
    ExifColour,
    read_bmp,
    read_cicp,
    read_colr,
    read_exif_colour,
    read_primaries,
)
from skinnet.images.colour_space import ColourSpace

_EXPONENTS = (0.4, 5.0)
"""Least and largest exponent from pixels to light that is taken from a file."""

_BOXED_FORMATS = ("HEIF", "AVIF", "JPEG2000")
_SRGB, _ADOBE, _WIDE_GAMUT, _UNCALIBRATED = 1, 2, 0xFFFD, 0xFFFF
"""Values of EXIF's tag ColorSpace; the second and third are not in the standard, but written."""

_ENUMERATED = {16: "sRGB", 17: "grey", 18: "sYCC"}
"""JPEG 2000's enumerated colour spaces that Pillow decodes to sRGB."""


class Decision(NamedTuple):
    """A colour space, and what the user should be told of the decision."""

    space: ColourSpace
    notes: tuple[str, ...] = ()


def decide_colour_space(image: Image.Image, data: bytes, channels: str, name: str) -> Decision:
    """Decide in which colour space the pixels of a picture are.

    Args:
        image: The open picture.
        data: Bytes of its file; empty for a picture from memory.
        channels: RGB, GRAY or CMYK.
        name: Name of the picture in errors and notes.

    Raises:
        InputError: The pixels are PQ or HLG.
    """
    notes: list[str] = []
    boxes = read_colr(data) if image.format in _BOXED_FORMATS else None
    found = _from_cicp(image, data, name)
    profile = image.info.get("icc_profile") or (boxes.profile if boxes else None)
    if boxes and boxes.code_points:
        _refuse_hdr(boxes.code_points[1], "an nclx box", name)
    if found is None and profile:
        found = _from_profile(profile, channels, name, notes)
    if found is None and boxes is not None:
        found = _from_boxes(boxes.code_points, boxes.enumerated, name, notes)
    if found is None and image.format == "BMP":
        found = _from_bmp(data, channels, name, notes)
    if found is None and channels == "RGB":
        found = _from_png(image, name, notes) or _from_exif(image, name, notes)
    if found is None:
        found = ColourSpace("sRGB" if channels != "CMYK" else "CMYK", "assumed")
    if channels == "CMYK" and found.profile is None:
        notes.append(
            f"{name} has CMYK pixels without a usable profile; their colours are a rough guess. "
            "Convert it to sRGB with the profile that it was made for."
        )
    return Decision(found, tuple(notes))


def _from_cicp(image: Image.Image, data: bytes, name: str) -> ColourSpace | None:
    cicp = read_cicp(data) if image.format == "PNG" else None
    if cicp is None:
        return None
    primaries, transfer, full_range = cicp
    _refuse_hdr(transfer, "its cICP chunk", name)
    space = find_coded_space(primaries, transfer)
    if space is None or not full_range:
        raise InputError(
            f"{name} states colours by a cICP chunk of primaries {primaries}, transfer {transfer} "
            f"and {'full' if full_range else 'narrow'} range, which is not read; save it as sRGB."
        )
    return _name(space, "cICP chunk")


def _from_profile(profile: bytes, channels: str, name: str, notes: list[str]) -> ColourSpace | None:
    points = read_code_points(profile)
    if points is not None:
        _refuse_hdr(points[1], "its colour profile", name)
    if fits_pixels(profile, channels) or (channels == "GRAY" and fits_pixels(profile, "RGB")):
        return ColourSpace(describe_profile(profile), "ICC profile", profile)
    taken = "sRGB" if channels != "CMYK" else "CMYK"
    notes.append(
        f"{name} has a colour profile that does not fit its {channels} pixels "
        f"({describe_profile(profile)}); it is taken as {taken}, as viewers do."
    )
    return None


def _from_boxes(
    points: tuple[int, int] | None, enumerated: int | None, name: str, notes: list[str]
) -> ColourSpace | None:
    if points is not None and points != (2, 2):
        space = find_coded_space(*points)
        if space is not None:
            # Encoders of still pictures write the codes of BT.709 for sRGB.
            return _name(SRGB if points in ((1, 1), (1, 6)) else space, "nclx box")
        notes.append(f"{name} states colours by codes {points}, not known; it is taken as sRGB.")
    if enumerated in _ENUMERATED:
        return ColourSpace("sRGB", "colr box")
    if enumerated is not None:
        notes.append(f"{name} states colour space {enumerated}, not known; it is taken as sRGB.")
    return None


def _from_bmp(data: bytes, channels: str, name: str, notes: list[str]) -> ColourSpace | None:
    stated = read_bmp(data)
    if stated.profile:
        found = _from_profile(stated.profile, channels, name, notes)
        return found and found._replace(known_from="BMP header")
    if stated.primaries is None or channels != "RGB":
        return None
    return _name(find_space(stated.primaries, stated.exponent), "BMP header")


def _from_png(image: Image.Image, name: str, notes: list[str]) -> ColourSpace | None:
    """The chunks sRGB, gAMA and cHRM, in the order of the PNG specification."""
    if "srgb" in image.info:
        return ColourSpace("sRGB", "sRGB chunk")
    gamma, chromaticity = image.info.get("gamma"), image.info.get("chromaticity")
    if not gamma and not chromaticity:
        return None
    exponent = 1 / gamma if gamma else None
    primaries = read_primaries(chromaticity[:2], chromaticity[2:]) if chromaticity else None
    broken = chromaticity is not None and primaries is None
    if broken or (exponent is not None and not _EXPONENTS[0] <= exponent <= _EXPONENTS[1]):
        notes.append(f"{name} states impossible colours (gAMA {gamma}, cHRM {chromaticity}).")
        return None
    known = " and ".join(
        chunk for chunk, value in (("gAMA", gamma), ("cHRM", chromaticity)) if value
    )
    plural = "s" if gamma and chromaticity else ""
    return _name(find_space(primaries or SRGB.primaries, exponent), f"{known} chunk{plural}")


def _from_exif(image: Image.Image, name: str, notes: list[str]) -> ColourSpace | None:
    stated = read_exif_colour(image)
    if stated.space == _SRGB or (stated.space is None and stated.interoperability == "R98"):
        return ColourSpace("sRGB", "EXIF")
    if stated.space == _ADOBE or stated.interoperability == "R03":
        return _name(ADOBE_RGB, "EXIF")
    if stated.space == _WIDE_GAMUT:
        return _name(WIDE_GAMUT_RGB, "EXIF")
    if stated.primaries is not None:
        known = "TIFF tags" if image.format == "TIFF" else "EXIF"
        return _name(find_space(stated.primaries, stated.exponent or 2.2), known)
    if stated.space == _UNCALIBRATED:
        return _from_uncalibrated(stated, name, notes)
    return None


def _from_uncalibrated(stated: ExifColour, name: str, notes: list[str]) -> ColourSpace | None:
    """EXIF that says "not sRGB" alone. Cameras write it for Adobe RGB, and name the file _X."""
    if stated.make.lower() == "apple":
        chosen, because = DISPLAY_P3, "telephones of Apple write Display P3"
    elif stated.interoperability == "" or PurePath(name).name.startswith("_"):
        chosen, because = ADOBE_RGB, "its name or its DCF directory is that of Adobe RGB"
    elif stated.make and stated.interoperability is None:
        chosen, because = ADOBE_RGB, f"a camera ({stated.make}) wrote it"
    else:
        notes.append(
            f"{name} states by EXIF that its colours are not calibrated, and names no space; it is "
            "taken as sRGB. Save it as sRGB if its colours are others."
        )
        return None
    notes.append(
        f"{name} states by EXIF only that it is not sRGB; it is taken as {chosen.name}, since "
        f"{because}."
    )
    return _name(chosen, "EXIF")


def _refuse_hdr(transfer: int, statement: str, name: str) -> None:
    if transfer in HDR_TRANSFERS:
        raise InputError(
            f"{name} is a picture of high dynamic range ({HDR_TRANSFERS[transfer]}, stated by "
            f"{statement}), in which white is not known; save it as sRGB."
        )


def _name(space: NamedSpace, known_from: str) -> ColourSpace:
    return ColourSpace(space.name, known_from, space.profile())
