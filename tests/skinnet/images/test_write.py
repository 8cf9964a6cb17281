"""Formats of results and what they hold; tests/reports compares whole files."""

import struct
import zlib
from io import BytesIO
from pathlib import Path

import numpy as np
import pytest
from picture_files import make_photo
from PIL import Image

from skinnet.errors import InputError
from skinnet.images import ColourSpace, Picture, read_picture
from skinnet.images._fit import blend_with_white, convert_to_srgb, reduce_depth
from skinnet.images._named_spaces import DISPLAY_P3
from skinnet.images._write import check_quality, choose_suffix, find_format, write_picture

GREY = np.full((4, 5, 3), 90, np.uint8)
P3 = ColourSpace("Display P3", "ICC profile", DISPLAY_P3.profile())


@pytest.mark.parametrize(
    ("kind", "suffix", "chosen"),
    [
        ("JPEG", ".JPG", ".JPG"),
        ("JPEG", ".jfif", ".jfif"),
        ("JPEG", ".png", ".jpg"),
        ("JPEG", "", ".jpg"),
        ("MPO", ".mpo", ".jpg"),
        ("MPO", ".jpg", ".jpg"),
        ("PNG", ".apng", ".png"),
        ("TIFF", ".tiff", ".tiff"),
        ("HEIF", ".HIF", ".HIF"),
        ("PPM", ".pnm", ".pnm"),
        ("", "", ".png"),
    ],
)
def test_a_result_keeps_its_format_and_suffix(kind: str, suffix: str, chosen: str) -> None:
    assert choose_suffix(Picture("a", GREY, format=kind), suffix) == (chosen, ())


@pytest.mark.parametrize(
    ("picture", "reason"),
    [
        (Picture("a", GREY, format="GIF"), "GIF holds 256 colours only"),
        (Picture("a", GREY, GREY[..., 0], format="BMP"), "BMP does not hold all that it has"),
        (Picture("a", GREY, None, P3, "BMP"), "BMP does not hold all that it has"),
    ],
)
def test_what_its_format_cannot_hold_becomes_png(picture: Picture, reason: str) -> None:
    suffix, notes = choose_suffix(picture, ".x")
    assert suffix == ".png" and notes == (f"The edit of a is written as PNG, since {reason}.",)


@pytest.mark.parametrize("name", ["a.gif", "a", "a.psd"])
def test_unknown_suffixes_are_refused(name: str) -> None:
    with pytest.raises(InputError, match=rf"{name} has to end in \.jpg, \.png"):
        find_format(Path(name))


def test_heic_names_its_extra(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("skinnet.images._write.find_spec", lambda name: None)
    with pytest.raises(InputError, match=r'pip install "skinnet\[heif\]"'):
        find_format(Path("a.heic"))


def test_opaque_alpha_is_left_out_without_words(tmp_path: Path) -> None:
    alpha = np.full(GREY.shape[:2], 255, np.uint8)
    assert write_picture(tmp_path / "a.jpg", Picture("a", GREY, alpha)) == ()


def test_an_older_file_stays_when_writing_fails(tmp_path: Path) -> None:
    (tmp_path / "a.webp").write_text("old")
    with pytest.raises(InputError, match="cannot be written"):
        write_picture(tmp_path / "a.webp", Picture("a", np.zeros((1, 17000, 3), np.uint8)))
    assert (tmp_path / "a.webp").read_text() == "old"
    assert [path.name for path in tmp_path.iterdir()] == ["a.webp"]


def test_grey_pictures_are_written_as_rgb(tmp_path: Path) -> None:
    for suffix in (".png", ".jpg", ".tif"):
        path = tmp_path / f"a{suffix}"
        assert write_picture(path, Picture("a", GREY[..., 0])) == ()
        with Image.open(path) as image:
            assert image.mode == "RGB" and image.getpixel((0, 0)) == (90, 90, 90)


@pytest.mark.parametrize("dtype", [np.uint8, np.uint16])
def test_transparent_pixels_become_white(dtype: type) -> None:
    top = np.iinfo(dtype).max
    alpha = np.array([[0, top, top // 2 + 1]], dtype)
    blended = blend_with_white(Picture("a", np.zeros((1, 3, 3), dtype), alpha))
    assert blended.alpha is None
    assert blended.pixels[0, :, 0].tolist() == [top, 0, top // 2]
    inks = blend_with_white(Picture("a", np.full((1, 3, 4), top, dtype), alpha))
    assert inks.pixels[0, :, 0].tolist() == [0, top, top // 2 + 1]


def test_depth_is_rounded() -> None:
    deep = np.array([[[0, 128, 129], [65535, 257, 65406]]], np.uint16)
    assert reduce_depth(Picture("a", deep)).pixels.tolist() == [[[0, 0, 1], [255, 1, 254]]]


def test_conversion_to_srgb_keeps_colours() -> None:
    picture = Picture("a", np.array([[[200, 120, 100]]], np.uint8), None, P3)
    converted = convert_to_srgb(picture)
    np.testing.assert_array_equal(converted.pixels, picture.srgb)
    assert convert_to_srgb(Picture("a", GREY)).pixels is GREY


def test_arrays_are_written_too(tmp_path: Path) -> None:
    write_picture(tmp_path / "a.png", read_picture(GREY))
    np.testing.assert_array_equal(read_picture(tmp_path / "a.png").pixels, GREY)


def read_levels(path: Path) -> np.ndarray:
    with Image.open(path) as image:
        return np.array(image.convert("RGB")).astype(int)


def make_noise() -> np.ndarray:
    return np.random.default_rng(0).integers(0, 256, (64, 64, 3), np.uint8)


@pytest.mark.parametrize("suffix", [".jpg", ".webp", ".avif", ".heic"])
def test_a_lower_quality_is_smaller_and_less_alike(tmp_path: Path, suffix: str) -> None:
    if suffix == ".heic":
        pytest.importorskip("pillow_heif")
    noise, found = make_noise(), []
    for quality in (30, 95):
        path = tmp_path / f"{quality}{suffix}"
        assert write_picture(path, Picture("a", noise), quality=quality) == ()
        difference = np.abs(read_picture(path).srgb.astype(int) - noise).mean()
        found.append((path.stat().st_size, -difference))
    assert found[0] < found[1] and found[0][1] < found[1][1]


@pytest.mark.parametrize("suffix", [".jpg", ".webp"])
def test_a_quality_that_is_asked_for_replaces_that_of_the_original(
    tmp_path: Path, suffix: str
) -> None:
    original = tmp_path / f"a{suffix}"
    Image.fromarray(make_noise()).save(original, quality=50, subsampling="4:2:0")
    picture = read_picture(original)
    for name, quality in (("own", None), ("high", 98), ("low", 10)):
        write_picture(tmp_path / f"{name}{suffix}", picture, quality=quality)
    own, high, low = (
        (tmp_path / f"{name}{suffix}").stat().st_size for name in ("own", "high", "low")
    )
    assert low < own < high
    if suffix == ".jpg":
        with Image.open(tmp_path / "high.jpg") as image:
            assert image.layer[0][1:3] == (2, 2)  # the subsampling stays


def test_formats_without_loss_say_that_they_have_no_quality(tmp_path: Path) -> None:
    for suffix, name in ((".png", "PNG"), (".tif", "TIFF"), (".bmp", "BMP"), (".ppm", "PPM")):
        path = tmp_path / f"a{suffix}"
        (said,) = write_picture(path, Picture("a", GREY), quality=50)
        assert said == f"{path} is written without loss: {name} has no quality."
        np.testing.assert_array_equal(read_levels(path), GREY)


@pytest.mark.parametrize("quality", [0, 101, -5])
def test_qualities_have_a_range(quality: int) -> None:
    with pytest.raises(InputError, match=f"from 1 to 100; got {quality}"):
        check_quality(quality)


def test_messages_name_the_file_as_they_are_told(tmp_path: Path) -> None:
    deep = Picture("a", GREY.astype(np.uint16))
    (said,) = write_picture(tmp_path / "a.jpg", deep, name="standard output")
    assert said.startswith("standard output has 8 bits a channel")


def test_chunks_of_no_known_form_are_left_out(tmp_path: Path) -> None:
    """Viewers refuse files with other chunks whose names say that they are needed."""
    file = BytesIO()
    Image.fromarray(make_photo()).save(file, "PNG")
    data, chunks = file.getvalue(), b""
    for name in (b"\x14\xc0\xb7D", b"NEED", b"okAy"):
        chunks += struct.pack(">I", 1) + name + b"x" + struct.pack(">I", zlib.crc32(name + b"x"))
    path = tmp_path / "a.png"
    write_picture(path, read_picture(data[:-12] + chunks + data[-12:]))
    assert b"okAy" in path.read_bytes() and b"NEED" not in path.read_bytes()
    np.testing.assert_array_equal(read_picture(path).srgb, make_photo())
