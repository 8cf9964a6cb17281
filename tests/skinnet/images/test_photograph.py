import io
import struct
import zlib
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from PIL import Image, ImageCms

from skinnet.errors import InputError
from skinnet.files import write_atomically, write_text, write_together
from skinnet.images import _decode, as_photo, linear_to_srgb, read_photo, srgb_to_linear, write_png


def photograph(height: int = 5, width: int = 7) -> np.ndarray:
    rows, columns = np.mgrid[:height, :width]
    return np.stack([rows * 40, columns * 30, 255 - rows * 20], -1).astype(np.uint8)


def saved(image: Image.Image, path: Path, **options: object) -> Path:
    image.save(path, **options)
    return path


@pytest.mark.parametrize("suffix", ["png", "bmp", "tif", "webp", "ppm", "gif"])
def test_lossless_formats_read_back_the_same(tmp_path: Path, suffix: str) -> None:
    photo = photograph()
    path = saved(Image.fromarray(photo), tmp_path / f"a.{suffix}", lossless=True)
    np.testing.assert_array_equal(read_photo(path), photo)


@pytest.mark.parametrize("orientation", range(1, 9))
@pytest.mark.parametrize("suffix", ["png", "tif", "jpg"])
def test_photographs_are_turned_upright(tmp_path: Path, suffix: str, orientation: int) -> None:
    exif = Image.Exif()
    exif[0x0112] = orientation
    # A dark left third and a bright top, large enough for JPEG to keep apart.
    photo = np.full((48, 96, 3), 100, np.uint8)
    photo[:16], photo[:, :32] = 250, 10
    path = saved(Image.fromarray(photo), tmp_path / f"a.{suffix}", exif=exif)
    square = photo.astype(int)
    turned = {
        1: square,
        2: square[:, ::-1],
        3: square[::-1, ::-1],
        4: square[::-1],
        5: square.transpose(1, 0, 2),
        6: np.rot90(square, -1),
        7: square[::-1, ::-1].transpose(1, 0, 2),
        8: np.rot90(square),
    }[orientation]
    read = read_photo(path)
    assert read.shape == turned.shape
    assert np.abs(read - turned).mean() < 1


def test_an_embedded_profile_is_converted_to_srgb(tmp_path: Path) -> None:
    photo = photograph()
    swapped = swapped_profile()
    path = saved(Image.fromarray(photo), tmp_path / "a.png", icc_profile=swapped)
    np.testing.assert_allclose(read_photo(path), photo[..., ::-1].astype(int), atol=1)


def test_the_srgb_profile_changes_nothing(tmp_path: Path) -> None:
    photo = photograph()
    path = saved(Image.fromarray(photo), tmp_path / "a.png", icc_profile=srgb_profile())
    np.testing.assert_allclose(read_photo(path), photo.astype(int), atol=1)


@pytest.mark.parametrize(("mode", "profile"), [("RGB", b"not a profile"), ("CMYK", None)])
def test_a_profile_that_cannot_be_used_is_refused(
    tmp_path: Path, mode: str, profile: bytes | None
) -> None:
    image = Image.fromarray(photograph()).convert(mode)
    path = saved(image, tmp_path / "a.tif", icc_profile=profile or srgb_profile())
    with pytest.raises(InputError, match=r"a\.tif has a colour profile .* save it again as sRGB"):
        read_photo(path)


def srgb_profile() -> bytes:
    content = ImageCms.ImageCmsProfile(ImageCms.createProfile("sRGB")).tobytes()
    return content[:24] + struct.pack(">6H", 2020, 1, 1, 0, 0, 0) + content[36:]  # not the clock's


def swapped_profile() -> bytes:
    """sRGB with the tags of its red and blue primaries exchanged."""
    table = srgb_profile()
    return table.replace(b"rXYZ", b"tXYZ").replace(b"bXYZ", b"rXYZ").replace(b"tXYZ", b"bXYZ")


@pytest.mark.parametrize("mode", ["RGBA", "LA", "P"])
def test_transparency_is_laid_on_white(tmp_path: Path, mode: str) -> None:
    image = Image.new("RGBA", (4, 2), (0, 0, 0, 255))
    image.putpixel((0, 0), (0, 0, 0, 0))
    image = image.convert(mode)
    read = read_photo(saved(image, tmp_path / "a.png"))
    assert read[0, 0].tolist() == [255, 255, 255]
    assert read[1, 3].tolist() == [0, 0, 0]


def test_half_transparency_is_half_white() -> None:
    image = Image.new("RGBA", (2, 2), (100, 0, 200, 128))
    np.testing.assert_allclose(as_photo(image)[0, 0], [177, 127, 227], atol=1)


@pytest.mark.parametrize(
    ("mode", "suffix"), [("L", "png"), ("1", "png"), ("P", "gif"), ("CMYK", "tif"), ("L", "jpg")]
)
def test_other_modes_keep_their_colour(tmp_path: Path, mode: str, suffix: str) -> None:
    white, black = Image.new("RGB", (8, 8), "white"), Image.new("RGB", (8, 8), "black")
    for image, value in ((white, 255), (black, 0)):
        read = read_photo(saved(image.convert(mode), tmp_path / f"a.{suffix}"))
        assert read.shape == (8, 8, 3)
        np.testing.assert_allclose(read, value, atol=2)


def test_cmyk_jpeg_is_inverted_if_adobe_wrote_it(tmp_path: Path) -> None:
    image = Image.new("CMYK", (16, 16), (0, 255, 255, 0))
    path = saved(image, tmp_path / "a.jpg", quality=100)
    red = read_photo(path)[8, 8]
    content = path.read_bytes()
    assert b"Adobe" in content
    at = content.index(b"Adobe") - 4
    plain = content[:at] + content[at + 2 + struct.unpack(">H", content[at + 2 : at + 4])[0] :]
    np.testing.assert_allclose(red, [255, 0, 0], atol=4)
    np.testing.assert_allclose(read_photo(io.BytesIO(plain))[8, 8], [0, 0, 0], atol=4)


@pytest.mark.parametrize("suffix", ["png", "tif", "pgm"])
def test_16_bit_grey_is_scaled_and_not_clipped(tmp_path: Path, suffix: str) -> None:
    grey = np.array([[0, 257, 128 * 257, 65535]], np.uint16)
    read = read_photo(saved(Image.fromarray(grey), tmp_path / f"a.{suffix}"))
    np.testing.assert_array_equal(read[0, :, 1], [0, 1, 128, 255])


def test_16_bit_rgb_png_is_read() -> None:
    row = b"\0" + struct.pack(">6H", 0, 32896, 65535, 65535, 257, 0)
    read = read_photo(io.BytesIO(png(2, 1, 16, 2, row)))
    np.testing.assert_array_equal(read, [[[0, 128, 255], [255, 1, 0]]])


def png(width: int, height: int, depth: int, colour: int, rows: bytes) -> bytes:
    head = struct.pack(">IIBBBBB", width, height, depth, colour, 0, 0, 0)
    chunks = ((b"IHDR", head), (b"IDAT", zlib.compress(rows)), (b"IEND", b""))
    return b"\x89PNG\r\n\x1a\n" + b"".join(
        struct.pack(">I", len(body)) + name + body + struct.pack(">I", zlib.crc32(name + body))
        for name, body in chunks
    )


@pytest.mark.parametrize("dtype", [np.float32, np.int32])
def test_pixels_without_a_known_white_are_refused(tmp_path: Path, dtype: type) -> None:
    path = saved(Image.fromarray(np.ones((4, 4), dtype)), tmp_path / "a.tif")
    with pytest.raises(InputError, match=r"a\.tif has pixels of Pillow's mode [FI], .* sRGB"):
        read_photo(path)


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (None, r"There is no file .*a\.jpg; check the path"),
        (b"", r"a\.jpg is empty \(0 bytes\)"),
        (b"#!/bin/sh\necho no picture\n", r"a\.jpg is not a picture that can be read; give a"),
        (b"%!PS-Adobe-3.0 EPSF-3.0\n%%BoundingBox: 0 0 9 9\n", r"not a picture"),
    ],
)
def test_what_is_no_picture_is_named(tmp_path: Path, content: bytes | None, words: str) -> None:
    path = tmp_path / "a.jpg"
    if content is not None:
        path.write_bytes(content)
    with pytest.raises(InputError, match=words):
        read_photo(path)


@pytest.mark.parametrize("suffix", ["jpg", "png", "webp", "tif", "bmp"])
def test_a_truncated_picture_is_refused(tmp_path: Path, suffix: str) -> None:
    noise = np.random.default_rng(0).integers(0, 255, (64, 64, 3), np.uint8)
    path = saved(Image.fromarray(noise), tmp_path / f"a.{suffix}")
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])
    with pytest.raises(InputError, match=rf"a\.{suffix} is (damaged|not a picture)"):
        read_photo(path)


def test_a_folder_and_a_name_that_cannot_be_are_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="is a folder; give a photograph in it"):
        read_photo(tmp_path)
    with pytest.raises(InputError, match="cannot be read"):
        read_photo("a\0b.jpg")


@pytest.mark.parametrize(("width", "height"), [(10_001, 10_000), (60_000, 60_000)])
def test_too_many_pixels_are_refused_by_the_header(width: int, height: int) -> None:
    limit = Image.MAX_IMAGE_PIXELS
    with pytest.raises(InputError, match=r"more pixels than the limit of 100,000,000; scale it"):
        read_photo(io.BytesIO(png(width, height, 8, 2, b"\0")))
    assert limit == Image.MAX_IMAGE_PIXELS


def test_pictures_up_to_the_limit_are_read_without_a_warning(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(Image, "MAX_IMAGE_PIXELS", 20)  # Pillow warns from here on
    assert read_photo(io.BytesIO(png(5, 5, 8, 0, b"\0\1\2\3\4\5" * 5))).shape == (5, 5, 3)


@pytest.mark.parametrize(
    "array",
    [
        np.full((4, 5), 128, np.uint8),
        np.full((4, 5, 1), 128, np.uint8),
        np.full((4, 5, 3), 128 / 255),
        np.full((4, 5, 4), 128, np.uint8) | np.array([0, 0, 0, 255], np.uint8),
        np.full((4, 5), 128 / 255, np.float32),
    ],
)
def test_arrays_are_photographs(array: np.ndarray) -> None:
    np.testing.assert_array_equal(as_photo(array), np.full((4, 5, 3), 128))


@pytest.mark.parametrize(
    ("array", "words"),
    [
        (np.full((4, 4, 3), np.nan), r"lies in \[0, 1\]; got nan"),
        (np.full((4, 4, 3), 128.0), r"got 128. Divide it by 255"),
        (np.full((4, 4, 3), -0.1), r"got -0\.1"),
        (np.full((4, 4, 3), np.inf), r"got inf"),
        (np.zeros((4, 4, 2)), r"got shape \[4, 4, 2\]"),
        (np.zeros((2, 4, 4, 3)), r"got shape \[2, 4, 4, 3\]"),
        (np.zeros((0, 4, 3)), r"got shape \[0, 4, 3\]"),
        (np.zeros(4), r"got shape \[4\]"),
        (np.zeros((4, 4, 3), np.int64), r"got int64"),
        (np.zeros((4, 4, 3), np.uint16), r"got uint16"),
    ],
)
def test_other_arrays_are_refused(array: np.ndarray, words: str) -> None:
    with pytest.raises(ValueError, match=words):
        as_photo(array)


def test_large_arrays_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(_decode, "MAX_PIXELS", 8)
    with pytest.raises(InputError, match="3 x 3, more pixels than the limit of 8"):
        as_photo(np.zeros((3, 3), np.uint8))


SIDES = st.integers(1, 12)


@given(
    photo=hnp.arrays(np.uint8, st.tuples(SIDES, SIDES, st.just(3))),
    suffix=st.sampled_from(["PNG", "TIFF", "BMP", "PPM"]),
    mode=st.sampled_from(["RGB", "L", "1", "CMYK", "RGBA", "LA", "P", "I;16"]),
)
def test_any_mode_and_size_is_read_as_pillow_shows_it(
    photo: np.ndarray, suffix: str, mode: str
) -> None:
    image = Image.fromarray(photo).convert("L" if mode == "I;16" else mode)
    if mode == "I;16":
        image = Image.fromarray(np.asarray(image).astype(np.uint16) * 257)
    buffer = io.BytesIO()
    try:
        image.save(buffer, suffix)
    except OSError:  # this format does not hold that mode
        return
    read = read_photo(io.BytesIO(buffer.getvalue()))
    if mode == "I;16":
        shown = np.asarray(image)[..., None].repeat(3, 2) // 257
    else:
        shown = np.asarray(image.convert("RGB"))
    np.testing.assert_array_equal(read, shown)


@given(content=st.binary(max_size=400))
def test_random_bytes_are_refused(content: bytes) -> None:
    with pytest.raises(InputError):
        read_photo(io.BytesIO(content))


@given(data=st.data(), kind=st.sampled_from(["PNG", "JPEG", "TIFF", "WEBP", "GIF", "BMP"]))
def test_damage_gives_a_photograph_or_a_sentence(data: st.DataObject, kind: str) -> None:
    buffer = io.BytesIO()
    exif = Image.Exif()
    exif[0x0112] = 6
    image = Image.fromarray(photograph(12, 16))
    image.save(buffer, kind, exif=exif, icc_profile=srgb_profile())
    content = bytearray(buffer.getvalue())
    for at in data.draw(st.lists(st.integers(0, len(content) - 1), max_size=6)):
        content[at] = data.draw(st.integers(0, 255))
    cut = data.draw(st.integers(0, len(content)))
    try:
        photo = read_photo(io.BytesIO(bytes(content[:cut])))
    except InputError as error:
        assert str(error).endswith((".", "?"))
    else:
        assert photo.dtype == np.uint8 and photo.ndim == 3 and photo.shape[2] == 3


def test_linear_and_srgb_are_inverse() -> None:
    every = np.arange(256, dtype=np.uint8)
    linear = srgb_to_linear(every)
    np.testing.assert_allclose(linear_to_srgb(linear) * 255, every, atol=1e-3)
    np.testing.assert_allclose(linear[[0, 1, 128, 255]], [0, 1 / 255 / 12.92, 0.2158605, 1], 1e-5)
    np.testing.assert_allclose(srgb_to_linear(every / 255), linear, atol=1e-6)


def test_png_carries_16_bits_and_text(tmp_path: Path) -> None:
    grey = np.array([[0, 1, 65535]], np.uint16)
    write_png(tmp_path / "a.png", grey, {"scale": "0.5", "unit": "fraction"})
    with Image.open(tmp_path / "a.png") as image:
        np.testing.assert_array_equal(np.asarray(image), grey)
        assert image.text == {"scale": "0.5", "unit": "fraction"}


def test_png_refuses_other_arrays(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="PNG is written from"):
        write_png(tmp_path / "a.png", np.zeros((2, 2, 3), np.uint16))
    assert not list(tmp_path.iterdir())


def test_a_failed_write_leaves_what_was_there(tmp_path: Path) -> None:
    path = tmp_path / "a.txt"
    write_text(path, "old")
    with pytest.raises(RuntimeError), write_atomically(path) as part:
        part.write_text("ne")
        raise RuntimeError
    assert [file.read_text() for file in tmp_path.iterdir()] == ["old"]


def test_files_appear_together_or_not_at_all(tmp_path: Path) -> None:
    (tmp_path / "b").mkdir()
    with pytest.raises(InputError, match="b is a folder"), write_together() as beside:
        beside(tmp_path / "a").write_text("a")
        beside(tmp_path / "b").write_text("b")
    with pytest.raises(FileNotFoundError), write_together() as beside:
        beside(tmp_path / "c").write_text("c")
        beside(tmp_path / "d")  # never written, so that its renaming fails
    assert [file.name for file in tmp_path.iterdir()] == ["b"]
