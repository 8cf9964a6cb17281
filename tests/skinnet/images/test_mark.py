import io
import json
from pathlib import Path

import numpy as np
import pytest
from PIL import Image, PngImagePlugin

from skinnet import __version__
from skinnet.images._mark import (
    EDITED,
    PROCESSING_SOFTWARE,
    Mark,
    append_mark,
    parse_mark,
    read_mark,
    read_summary,
)
from skinnet.images._png_file import write_png

DIGEST = "0123456789abcdef" * 4
EDIT = Mark("edit", EDITED, DIGEST)
SUMMARY = {"maps": {}, "light": {}, "camera": {}, "skin_share": 0.1}
GREY = np.full((4, 5, 3), 90, np.uint8)


def save(path: Path, **options: object) -> Path:
    Image.fromarray(GREY).save(path, **options)
    return path


def make_exif(text: str, tag: int = PROCESSING_SOFTWARE) -> Image.Exif:
    exif = Image.Exif()
    exif[0x0110] = "A camera"
    exif[tag] = text
    return exif


def test_a_line_says_the_whole_mark() -> None:
    assert str(EDIT) == f"skinnet {__version__} edit edited sha256:{DIGEST}"
    assert str(Mark("predict", "map", "", "0.1")) == "skinnet 0.1 predict map"
    assert parse_mark(str(EDIT)) == EDIT
    assert parse_mark(str(EDIT).encode() + b"\0") == EDIT


@pytest.mark.parametrize(
    "text", ["", "skinnet", "skinnetwork 1.0 edit photo", "GIMP 2.10", None, 7, b"\xff\xfe"]
)
def test_other_lines_are_no_marks(text: object) -> None:
    assert parse_mark(text) is None


@pytest.mark.parametrize("array", [GREY, np.full((4, 5), 9000, np.uint16)])
def test_png_carries_it_as_text(tmp_path: Path, array: np.ndarray) -> None:
    mark = Mark("predict", "panel", DIGEST)
    write_png(tmp_path / "a.png", array, mark.to_text())
    assert read_mark(tmp_path / "a.png") == mark
    with Image.open(tmp_path / "a.png") as image:
        assert image.text["Software"] == f"skinnet {__version__}"


@pytest.mark.parametrize("suffix", ["jpg", "tif", "webp", "png", "avif", "mpo"])
@pytest.mark.parametrize("tag", [PROCESSING_SOFTWARE, 0x0131])
def test_exif_carries_it(tmp_path: Path, suffix: str, tag: int) -> None:
    path = save(tmp_path / f"a.{suffix}", exif=make_exif(str(EDIT), tag))
    assert read_mark(path) == EDIT
    assert read_mark(str(path)) == EDIT
    wrong = path.rename(tmp_path / "wrong.dat")
    assert read_mark(wrong) == EDIT


@pytest.mark.parametrize("suffix", ["bmp", "ppm", "gif", "jp2", "jpg", "tif"])
def test_it_can_be_appended_and_the_picture_stays(tmp_path: Path, suffix: str) -> None:
    path = save(tmp_path / f"a.{suffix}")
    with Image.open(path) as image:
        before = np.array(image.convert("RGB"))
    assert read_mark(path) is None
    append_mark(path, EDIT)
    assert read_mark(path) == EDIT
    with Image.open(path) as image:
        np.testing.assert_array_equal(np.array(image.convert("RGB")), before)


def test_text_after_the_pixels_is_found(tmp_path: Path) -> None:
    path = save(tmp_path / "a.png")
    marked = tmp_path / "b.png"
    write_png(marked, GREY, EDIT.to_text())
    chunks = marked.read_bytes()
    start, end = chunks.index(b"tEXt") - 4, chunks.index(b"IDAT") - 4
    plain = path.read_bytes()
    path.write_bytes(plain[:-12] + chunks[start:end] + plain[-12:])
    assert read_mark(path) == EDIT


@pytest.mark.parametrize("kind", ["compressed", "international", "both"])
def test_text_that_other_programs_have_written_anew_is_found(tmp_path: Path, kind: str) -> None:
    info = PngImagePlugin.PngInfo()
    for key, value in EDIT.to_text().items():
        if kind == "compressed":
            info.add_text(key, value, zip=True)
        else:
            info.add_itxt(key, value, zip=kind == "both")
    assert read_mark(save(tmp_path / "a.png", pnginfo=info)) == EDIT


def test_an_open_file_keeps_its_place(tmp_path: Path) -> None:
    file = io.BytesIO(save(tmp_path / "a.jpg", exif=make_exif(str(EDIT))).read_bytes())
    file.seek(3)
    assert read_mark(file) == EDIT
    assert file.tell() == 3


def test_maps_of_earlier_versions_are_known_by_their_scale(tmp_path: Path) -> None:
    text = {"map": "melanin", "scale": "1e-5", "offset": "0.0", "unit": "volume fraction"}
    write_png(tmp_path / "a.png", np.zeros((3, 3), np.uint16), text)
    assert read_mark(tmp_path / "a.png") == Mark("predict", "map", "", "")
    del text["unit"]
    write_png(tmp_path / "b.png", np.zeros((3, 3), np.uint16), text)
    assert read_mark(tmp_path / "b.png") is None


@pytest.mark.parametrize("part", ["panel", "reconstruction"])
@pytest.mark.parametrize(
    ("content", "known"),
    [
        (json.dumps(SUMMARY), True),
        (json.dumps({"file": "a.jpg", "maps": {}}), False),
        ("[1, 2]", False),
        ("{", False),
        ("", False),
    ],
)
def test_pictures_of_earlier_versions_are_known_by_their_summary(
    tmp_path: Path, part: str, content: str, known: bool
) -> None:
    picture = save(tmp_path / f"my_own_{part}.png")
    assert read_mark(picture) is None
    (tmp_path / "my_own.json").write_text(content)
    assert read_mark(picture) == (Mark("predict", part, "", "") if known else None)
    assert (read_summary(tmp_path / "my_own.json") is not None) == known


@pytest.mark.parametrize(
    ("name", "archive"), [("s_panel.png", "s_maps.npz"), ("s_shape.png", "s_shape.npz")]
)
def test_pictures_of_scans_are_known_by_their_archive(
    tmp_path: Path, name: str, archive: str
) -> None:
    picture = save(tmp_path / name)
    assert read_mark(picture) is None
    (tmp_path / archive).write_bytes(b"")
    assert read_mark(picture) is not None


def test_photographs_carry_none(tmp_path: Path) -> None:
    info = PngImagePlugin.PngInfo()
    info.add_text("Software", "GIMP 2.10")
    info.add_text("Comment", "made with skinnet 1.0 predict map")
    assert read_mark(save(tmp_path / "a.png", pnginfo=info)) is None
    exif = make_exif("darktable 4.2", 0x0131)
    assert read_mark(save(tmp_path / "a.jpg", exif=exif)) is None
    assert read_mark(save(tmp_path / "a_panel.png")) is None


@pytest.mark.parametrize("length", [0, 1, 8, 20, 60, 90])
@pytest.mark.parametrize("suffix", ["jpg", "png", "tif", "gif"])
def test_damaged_files_carry_none(tmp_path: Path, suffix: str, length: int) -> None:
    whole = save(tmp_path / f"a.{suffix}").read_bytes()
    (tmp_path / "cut").write_bytes(whole[:length])
    assert read_mark(tmp_path / "cut") is None


def test_what_cannot_be_opened_carries_none(tmp_path: Path) -> None:
    assert read_mark(tmp_path) is None
    assert read_mark(tmp_path / "absent.png") is None
