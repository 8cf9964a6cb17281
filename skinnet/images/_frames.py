"""The pictures of a file beside its first; previews, masks and gain maps are none."""

from typing import Any

from PIL import Image

from skinnet.files import READ_ERRORS

_SUBFILE_TYPE, _REDUCED_OR_MASK = 254, 1 | 4
_ENTRIES = 0xB002
_GAIN_MAPS = (
    b"http://ns.adobe.com/hdr-gain-map/",
    b"http://ns.apple.com/HDRGainMap/",
    b"urn:iso:std:iso:ts:21496:-1",
)
"""What JPEG files hold that have a gain map, from Google, Apple and ISO 21496-1."""

_MOST_PAGES = 64


def describe_frames(image: Image.Image, data: bytes, name: str) -> tuple[str, ...]:
    """Say how many pictures a file holds, if the first is not the only one."""
    count = getattr(image, "n_frames", 1)
    try:
        if count > 1 and image.format == "MPO":
            count = _count_parts(image, data)
        elif 1 < count <= _MOST_PAGES and image.format == "TIFF":
            count = _count_pages(image, count)
    except READ_ERRORS:
        pass
    if count == 1:
        return ()
    return (f"{name} holds {count} pictures; the first is read.",)


def _count_parts(image: Image.Image, data: bytes) -> int:
    """Parts of a Multi-Picture file that are neither previews, as cameras add them, nor gain maps.

    Source:
        CIPA DC-007, 5.2.3.3.
    """
    entries: Any = image.mpinfo[_ENTRIES]  # type: ignore[attr-defined]
    kinds = [entry["Attribute"]["MPType"] for entry in entries]
    large = sum(not kind.startswith("Large Thumbnail") for kind in kinds)
    has_map = any(text in data for text in _GAIN_MAPS)
    return max(1, large - (has_map and "Undefined" in kinds))


def _count_pages(image: Image.Image, count: int) -> int:
    """Pages of a TIFF file that are neither of reduced size nor masks of others."""
    kinds = []
    for number in range(count):
        image.seek(number)
        tags: Any = image.tag_v2  # type: ignore[attr-defined]
        kinds.append(int(tags.get(_SUBFILE_TYPE, 0)))
    image.seek(0)
    return 1 + sum(not kind & _REDUCED_OR_MASK for kind in kinds[1:])
