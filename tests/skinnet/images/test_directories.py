import io
import struct

import numpy as np
import pytest
import tifffile
from PIL import Image

from skinnet.images._directories import (
    Tag,
    list_entries,
    make_rational,
    make_short,
    make_text,
    read_directory,
    read_header,
    read_number,
    write_block,
)


@pytest.mark.parametrize("order", ["<", ">"])
def test_what_is_written_is_read_again(order: str) -> None:
    inner = {0x927C: Tag(7, 5, b"notes"), 0xA002: make_short(40, order)}
    tags = {
        0x010F: make_text("a maker"),
        0x0112: make_short(6, order),
        0x011A: make_rational(299.5, order),
        0x8769: inner,
    }
    block = write_block(tags, order)
    assert read_directory(block, read_header(block)) == tags
    exif = Image.Exif()
    exif.load(b"Exif\0\0" + block)
    assert exif[0x010F] == "a maker" and exif[0x0112] == 6 and exif[0x011A] == 299.5
    assert exif.get_ifd(0x8769)[0x927C] == b"notes"


@pytest.mark.parametrize("bigtiff", [False, True])
@pytest.mark.parametrize("byteorder", ["<", ">"])
def test_tiff_files(bigtiff: bool, byteorder: str) -> None:
    file = io.BytesIO()
    options = {"byteorder": byteorder, "bigtiff": bigtiff, "metadata": None}
    tifffile.imwrite(file, np.zeros((2, 3), np.uint8), description="words of a file", **options)
    data = file.getvalue()
    header = read_header(data)
    assert (header.order, header.big) == (byteorder, bigtiff)
    tags = read_directory(data, header)
    assert tags[270] == Tag(2, 16, b"words of a file\0")
    width = tags[256]
    assert isinstance(width, Tag) and read_number(width, header.order) == 3


def test_values_outside_of_the_data_are_left_out() -> None:
    block = bytearray(write_block({1: make_text("a long text"), 2: make_short(5, "<")}, "<"))
    struct.pack_into("<I", block, 8 + 2 + 8, 9999)
    data = bytes(block)
    assert set(read_directory(data, read_header(data))) == {2}


@pytest.mark.parametrize("data", [b"", b"II", b"GIF89a..", b"II\x11\0aaaa"])
def test_no_header_is_a_value_error(data: bytes) -> None:
    with pytest.raises(ValueError, match="no TIFF header"):
        read_header(data)


def test_a_directory_outside_of_the_data_is_a_value_error() -> None:
    block = write_block({1: make_short(1, "<")}, "<")
    with pytest.raises(ValueError, match="cut short"):
        list_entries(block, read_header(block), 5000)
    with pytest.raises(ValueError, match="65535 tags"):
        list_entries(block + b"\xff\xff", read_header(block), len(block))


def test_a_directory_that_holds_itself_ends() -> None:
    block = bytearray(write_block({0x8769: {1: make_short(1, "<")}}, "<"))
    struct.pack_into("<I", block, 8 + 2 + 8, 8)
    data = bytes(block)
    assert read_directory(data, read_header(data))


def test_a_text_is_no_number() -> None:
    with pytest.raises(ValueError, match="type 2"):
        read_number(make_text("a"), "<")
