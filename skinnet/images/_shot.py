"""What EXIF states of how a photograph was taken."""

import struct
from typing import NamedTuple

from skinnet.files import READ_ERRORS
from skinnet.images._directories import (
    EXIF_IFD,
    Directory,
    Tag,
    read_directory,
    read_header,
    read_number,
)

_MAKE, _MODEL = 0x010F, 0x0110
_LIGHT_SOURCE, _FLASH, _WHITE_BALANCE = 0x9208, 0x9209, 0xA403
_FIRED = 1
_BALANCES = {0: "auto", 1: "manual"}
_LIGHTS = {
    **{1: "daylight", 2: "fluorescent", 3: "tungsten", 4: "flash", 9: "fine weather"},
    **{10: "cloudy", 11: "shade", 12: "daylight fluorescent", 13: "day white fluorescent"},
    **{14: "cool white fluorescent", 15: "white fluorescent", 16: "warm white fluorescent"},
    **{17: "standard light A", 18: "standard light B", 19: "standard light C", 20: "D55"},
    **{21: "D65", 22: "D75", 23: "D50", 24: "ISO studio tungsten", 255: "other"},
}


class Shot(NamedTuple):
    """How a photograph was taken, as EXIF states it; None is what it does not state.

    Attributes:
        camera: Maker and model.
        flash: Whether a flash fired.
        white_balance: auto or manual.
        light_source: The light that the camera was set to, such as daylight.

    Source:
        Exif 2.32 (CIPA DC-008), sections 4.6.4 and 4.6.5.
    """

    camera: str | None = None
    flash: bool | None = None
    white_balance: str | None = None
    light_source: str | None = None


def read_shot(block: bytes) -> Shot:
    """Read how a photograph was taken from its EXIF block; nothing if that is damaged."""
    try:
        header = read_header(block)
        tags = read_directory(block, header)
    except (ValueError, *READ_ERRORS):
        return Shot()
    inner = tags.get(EXIF_IFD, {})
    numbers = _read_numbers(inner if isinstance(inner, dict) else {}, header.order)
    flash = numbers.get(_FLASH)
    return Shot(
        _name_camera(_read_text(tags, _MAKE), _read_text(tags, _MODEL)),
        None if flash is None else bool(flash & _FIRED),
        _BALANCES.get(numbers.get(_WHITE_BALANCE, -1)),
        _LIGHTS.get(numbers.get(_LIGHT_SOURCE, -1)),
    )


def _read_numbers(tags: Directory, order: str) -> dict[int, int]:
    found = {}
    for tag in (_FLASH, _WHITE_BALANCE, _LIGHT_SOURCE):
        item = tags.get(tag)
        if isinstance(item, Tag):
            try:
                found[tag] = read_number(item, order)
            except (ValueError, struct.error):
                continue
    return found


def _read_text(tags: Directory, tag: int) -> str:
    item = tags.get(tag)
    text = item.value.decode("utf-8", "replace") if isinstance(item, Tag) else ""
    return " ".join(text.partition("\0")[0].split())


def _name_camera(make: str, model: str) -> str | None:
    """Maker and model, without a maker that the model begins with."""
    if make and model.lower().startswith(make.lower().split()[0]):
        return model
    return f"{make} {model}".strip() or None
