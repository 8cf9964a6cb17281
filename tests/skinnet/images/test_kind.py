import io
import sys

import pytest
from other_files import KINDS, RAW, directory, tiff

from skinnet.images._kind import (
    EMPTY,
    HEIF,
    OTHER,
    PICTURE,
    THUMBNAIL,
    Kind,
    identify,
    is_readable,
    promises_picture,
)
from skinnet.images._kind import RAW as RAW_KIND


def look(content: bytes, name: str = "") -> Kind:
    return identify(io.BytesIO(content), name)


@pytest.mark.parametrize(
    ("kind", "name"), [(kind, name) for kind, files in KINDS.items() for name in files]
)
def test_kinds_are_known(kind: str, name: str) -> None:
    found = look(KINDS[kind][name], name)
    assert kind in found.many or found is OTHER


@pytest.mark.parametrize(
    "head",
    [
        *(b"\xff\xd8\xff\xe0", b"\x89PNG\r\n\x1a\n", b"GIF87a", b"GIF89a", b"II*\0", b"MM\0*"),
        *(b"II+\0", b"MM\0+", b"RIFF\0\0\0\0WEBPVP8 ", b"\0\0\0\x0cjP  \r\n\x87\n"),
        *(b"\xff\x4f\xff\x51", b"P6 2 1 255 ", b"P5\n# made by hand\n# twice\n3 4\n255\n"),
        *(b"P1\r\n2\t2\r\n", b"BM" + bytes(12) + b"\x28\0\0\0", b"BM" + bytes(12) + b"\x7c\0\0\0"),
        *(b"\0\0\0\x1cftypavif\0\0\0\0mif1miaf", b"\0\0\0\x1cftypmif1\0\0\0\0mif1avif"),
    ],
)
def test_pictures_are_known(head: bytes) -> None:
    assert look(head + bytes(40)) is PICTURE
    assert is_readable(PICTURE)


@pytest.mark.parametrize(
    "text", [b"P6 report 3", b"BMW " + b"x" * 40, b"P6" + b" " * 5000, b"P7\nWIDTH 3\n", b"GIF90a"]
)
def test_texts_that_begin_alike_are_none(text: bytes) -> None:
    assert look(text) is OTHER


def test_the_content_comes_before_the_ending() -> None:
    assert look(b"\xff\xd8\xff\xe0", "a.nef") is PICTURE
    assert look(b"\xff\xd8\xff\xe0", "MVI_1.THM") is THUMBNAIL
    assert look(b"", "a.jpg") is EMPTY
    assert look(tiff([(262, 4, 2)]), "a.tif") is PICTURE
    assert look(tiff([(262, 4, 2)]), "a.NEF") is RAW_KIND
    assert look(b"what is this", "a.arw") is RAW_KIND


@pytest.mark.parametrize(("kind", "package"), [(HEIF, "pillow_heif"), (RAW_KIND, "rawpy")])
def test_an_extra_makes_kinds_readable(
    kind: Kind, package: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert is_readable(PICTURE) and not is_readable(OTHER)
    assert is_readable(kind)
    monkeypatch.setitem(sys.modules, package, None)
    assert not is_readable(kind)


@pytest.mark.parametrize("order", ["<", ">"])
@pytest.mark.parametrize("sub", [False, True])
@pytest.mark.parametrize(
    "tags",
    [
        *([(262, 4, 32803)], [(262, 4, 34892)], [(259, 4, 34713)], [(259, 4, 65535)]),
        *([(50706, 4, 1)], [(50752, 4, 1)], [(34310, 4, 1)]),
    ],
)
def test_raw_files_inside_tiff_are_known(
    tags: list[tuple[int, int, int]], sub: bool, order: str
) -> None:
    assert look(tiff(tags, order, sub)) is RAW_KIND


def test_a_sensor_in_a_later_directory_makes_a_raw_file() -> None:
    first = directory([(262, 4, 2)], "<")
    chained = first[:-4] + (8 + len(first)).to_bytes(4, "little")
    assert look(b"II*\0\x08\0\0\0" + chained + directory([(262, 4, 32803)], "<")) is RAW_KIND


@pytest.mark.parametrize("loop", [8, 0, 10_000])
def test_damaged_directories_end(loop: int) -> None:
    first = directory([(262, 4, 2), (330, 4, loop)], "<")
    assert look(b"II*\0\x08\0\0\0" + first[:-4] + loop.to_bytes(4, "little")) is PICTURE


@pytest.mark.parametrize("length", range(12, 60, 7))
def test_files_that_are_cut_have_a_kind(length: int) -> None:
    for content in RAW.values():
        assert look(content[:length]) in (PICTURE, RAW_KIND, OTHER)


@pytest.mark.parametrize(
    ("name", "kind", "promised"),
    [
        *(("a.jpg", OTHER, True), ("a.JPG_large", OTHER, True), ("a.jpeg~", OTHER, True)),
        *(("a.tif", RAW_KIND, True), ("a.heic", OTHER, True), ("a.heic", HEIF, False)),
        *(("a.jpg", HEIF, True), ("a.nef", RAW_KIND, False), ("a.txt", OTHER, False)),
        *(("a", OTHER, False), ("jpg", OTHER, False), ("a.jpgs", OTHER, False)),
    ],
)
def test_endings_promise_pictures(name: str, kind: Kind, promised: bool) -> None:
    assert promises_picture(name, kind) == promised
