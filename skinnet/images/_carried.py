"""What an edited photograph takes over from its original beside the pixels."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from PIL import Image

from skinnet.images._colour_decision import decide_colour_space
from skinnet.images._exif import update_exif
from skinnet.images._icc import make_srgb_profile
from skinnet.images._mark import Mark
from skinnet.images._resources import update_resources
from skinnet.images._xmp import update_xmp
from skinnet.images.picture import Picture


@dataclass(frozen=True)
class Carried:
    """What is written beside the pixels; empty is what there is not.

    Attributes:
        exif: A TIFF block.
        xmp: A packet.
        photoshop: Image resources, among them IPTC.
        profile: The colour profile to embed.
        dpi: Resolution across and down.
        comment: A comment.
        text: Texts by keyword.
        mark: The mark of a result, or None.
        own: What the original's own format adds (`Picture.metadata`), for a file of that format.
        problems: What could not be taken over, to be continued by what that means.
    """

    exif: bytes = b""
    xmp: bytes = b""
    photoshop: bytes = b""
    profile: bytes = b""
    dpi: tuple[float, float] | None = None
    comment: bytes = b""
    text: Mapping[str, str] = field(default_factory=dict)
    mark: Mark | None = None
    own: Mapping[str, Any] = field(default_factory=dict)
    problems: tuple[str, ...] = ()


def carry(picture: Picture, mark: Mark | None, in_exif: frozenset[str], name: str) -> Carried:
    """Collect what a picture carries, updated for its pixels as they are.

    Args:
        picture: The edited picture, and the metadata of its original.
        mark: The mark of the result.
        in_exif: What the target's format can state by EXIF alone: `mark`, `dpi`.
        name: Name of the file to write, which can say what EXIF leaves open of the colours.
    """
    metadata = picture.metadata
    size = picture.pixels.shape[1], picture.pixels.shape[0]
    dpi = _read_dpi(metadata.get("dpi"))
    exif, problems = _carry_exif(
        metadata.get("exif", b""),
        size,
        # An earlier mark in EXIF must not outlive the edit that it is of.
        str(mark) if mark and ("mark" in in_exif or metadata.get("exif")) else "",
        dpi if "dpi" in in_exif else None,
    )
    comment = metadata.get("comment", b"")
    return Carried(
        exif,
        update_xmp(metadata.get("xmp", b""), size),
        update_resources(metadata.get("photoshop", b"")),
        _choose_profile(picture, exif, name),
        dpi,
        comment if isinstance(comment, bytes) else str(comment).encode(),
        metadata.get("text", {}),
        mark,
        metadata,
        problems,
    )


def _carry_exif(
    block: bytes, size: tuple[int, int], line: str, dpi: tuple[float, float] | None
) -> tuple[bytes, tuple[str, ...]]:
    try:
        return update_exif(block, size, line, dpi), ()
    except ValueError:
        return update_exif(b"", size, line, dpi), ("damaged EXIF",)


def _read_dpi(dpi: Any) -> tuple[float, float] | None:
    try:
        x, y = (float(value) for value in dpi)
    except (TypeError, ValueError, ZeroDivisionError):
        return None
    return (x, y) if 0.01 < x < 1e6 and 0.01 < y < 1e6 else None


def _choose_profile(picture: Picture, exif: bytes, name: str) -> bytes:
    """The profile to embed: the original's own, or one for what EXIF does not surely state."""
    space = picture.colour_space
    if space.known_from == "ICC profile" or picture.pixels.shape[2:] != (3,):
        return space.profile or b""
    probe = Image.new("RGB", (1, 1))
    if exif:
        probe.info["exif"] = b"Exif\0\0" + exif
    stated = decide_colour_space(probe, b"", "RGB", name)
    if stated.space.profile == space.profile and not stated.notes:
        return b""
    return space.profile or make_srgb_profile()
