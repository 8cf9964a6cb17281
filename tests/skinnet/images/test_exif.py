import io
import struct

import pytest
from PIL import ExifTags, Image

from skinnet.images._exif import read_orientation, strip_prefix, update_exif

SIZE = (30, 40)
LINE = "skinnet 1.0 edit edited"


def make_block(order: str, orientation: int = 6, thumbnail: bytes = b"") -> bytes:
    """A camera's EXIF, with notes that hold an offset into it, in either byte order."""
    notes = b"notes of a maker"
    entries = [
        struct.pack(f"{order}HHIH2x", 0x0112, 3, 1, orientation),
        struct.pack(f"{order}HHII", 0x8769, 4, 1, 100),
    ]
    block = (b"II*\0" if order == "<" else b"MM\0*") + struct.pack(f"{order}I", 8)
    block += struct.pack(f"{order}H", 2) + b"".join(entries)
    block += struct.pack(f"{order}I", 200 if thumbnail else 0)
    block = block.ljust(100, b"\0") + struct.pack(f"{order}H", 2)
    block += struct.pack(f"{order}HHII", 0x927C, 7, len(notes), 150)
    block += struct.pack(f"{order}HHII", 0xA002, 4, 1, 40) + bytes(4)
    block = block.ljust(150, b"\0") + notes
    if thumbnail:
        block = block.ljust(200, b"\0") + struct.pack(f"{order}H", 2)
        block += struct.pack(f"{order}HHII", 0x0201, 4, 1, 230)
        block += struct.pack(f"{order}HHII", 0x0202, 4, 1, len(thumbnail)) + bytes(4)
        block = block.ljust(230, b"\0") + thumbnail
    return block


def parse(block: bytes) -> Image.Exif:
    exif = Image.Exif()
    exif.load(b"Exif\0\0" + block)
    return exif


@pytest.mark.parametrize("order", ["<", ">"])
def test_only_what_an_edit_makes_untrue_changes(order: str) -> None:
    block = make_block(order)
    assert read_orientation(block) == 6
    updated = update_exif(block, SIZE, LINE, (300.0, 150.0))
    exif = parse(updated)
    assert exif[0x0112] == read_orientation(updated) == 1
    assert exif.get_ifd(0x8769)[0xA002] == SIZE[0]
    assert exif.get_ifd(0x8769)[0x927C] == b"notes of a maker"
    assert exif[0x000B] == LINE
    assert (exif[0x011A], exif[0x011B], exif[0x0128]) == (300, 150, 2)
    assert updated[100 : 112 + 2] == block[100 : 112 + 2]
    assert updated.index(b"notes") == block.index(b"notes") == 150


@pytest.mark.parametrize("order", ["<", ">"])
@pytest.mark.parametrize("tail", [b"", b"something after it"])
def test_the_thumbnail_is_removed(order: str, tail: bytes) -> None:
    buffer = io.BytesIO()
    Image.new("RGB", (8, 8), "red").save(buffer, "JPEG")
    thumbnail = buffer.getvalue()
    updated = update_exif(make_block(order, thumbnail=thumbnail) + tail, SIZE, LINE)
    assert thumbnail[:40] not in updated and tail in updated
    assert not parse(updated).get_ifd(ExifTags.IFD.IFD1)


def test_a_wrong_offset_of_a_thumbnail_wipes_nothing() -> None:
    block = bytearray(make_block("<", thumbnail=b"\xff\xd8 picture"))
    struct.pack_into("<I", block, 200 + 2 + 8, 8)
    exif = parse(update_exif(bytes(block), SIZE, LINE))
    assert exif.get_ifd(0x8769)[0x927C] == b"notes of a maker"


def test_without_exif_there_is_only_what_is_added() -> None:
    assert update_exif(b"", SIZE, "") == b""
    assert dict(parse(update_exif(b"", SIZE, LINE))) == {0x000B: LINE}


def test_an_update_of_an_update_replaces_the_line() -> None:
    once = update_exif(make_block("<"), SIZE, LINE)
    twice = update_exif(once, SIZE, "another line")
    assert parse(twice)[0x000B] == "another line"


@pytest.mark.parametrize("block", [b"no EXIF", b"II*\0\xff\xff\xff\x7f", b"II+\0\x08\0\0\0" * 3])
def test_damage_is_a_value_error(block: bytes) -> None:
    with pytest.raises(ValueError, match=r"directory|header|8 bytes"):
        update_exif(block, SIZE, LINE)
    assert read_orientation(block) == 1


@pytest.mark.parametrize(
    ("xmp", "orientation"),
    [
        (b'<x tiff:Orientation="8"/>', 8),
        (b"<tiff:Orientation>3</tiff:Orientation>", 3),
        (b"<x/>", 1),
    ],
)
def test_orientation_by_xmp(xmp: bytes, orientation: int) -> None:
    assert read_orientation(b"", xmp) == orientation


def test_prefixes_are_stripped() -> None:
    assert strip_prefix(b"Exif\0\0Exif\0\0II*\0") == strip_prefix(b"II*\0") == b"II*\0"
