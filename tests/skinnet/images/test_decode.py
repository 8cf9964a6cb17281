import io
import struct
from pathlib import Path

import numpy as np
import pytest
from picture_files import (
    encode_png,
    make_photo,
    make_srgb_profile,
    make_swapped_profile,
    save_image,
)
from PIL import Image

from skinnet.errors import InputError
from skinnet.images import _decode, read_photo, read_picture


@pytest.mark.parametrize("orientation", range(1, 9))
@pytest.mark.parametrize("suffix", ["png", "tif", "jpg"])
def test_photographs_are_turned_upright(tmp_path: Path, suffix: str, orientation: int) -> None:
    exif = Image.Exif()
    exif[0x0112] = orientation
    # A dark left third and a bright top, large enough for JPEG to keep apart.
    photo = np.full((48, 96, 3), 100, np.uint8)
    photo[:16], photo[:, :32] = 250, 10
    path = save_image(Image.fromarray(photo), tmp_path / f"a.{suffix}", exif=exif)
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
    photo = make_photo()
    swapped = make_swapped_profile()
    path = save_image(Image.fromarray(photo), tmp_path / "a.png", icc_profile=swapped)
    np.testing.assert_allclose(read_photo(path), photo[..., ::-1].astype(int), atol=1)


def test_the_srgb_profile_changes_nothing(tmp_path: Path) -> None:
    photo = make_photo()
    path = save_image(Image.fromarray(photo), tmp_path / "a.png", icc_profile=make_srgb_profile())
    np.testing.assert_allclose(read_photo(path), photo.astype(int), atol=1)


@pytest.mark.parametrize(("mode", "profile"), [("RGB", b"not a profile"), ("CMYK", None)])
def test_a_profile_that_does_not_fit_is_not_used_and_said(
    tmp_path: Path, mode: str, profile: bytes | None
) -> None:
    image = Image.fromarray(make_photo()).convert(mode)
    path = save_image(image, tmp_path / "a.tif", icc_profile=profile or make_srgb_profile())
    picture = read_picture(path)
    np.testing.assert_array_equal(picture.srgb, np.asarray(image.convert("RGB")))
    assert picture.colour_space.known_from == "assumed"
    assert f"a.tif has a colour profile that does not fit its {mode} pixels" in picture.notes[0]


@pytest.mark.parametrize("mode", ["RGBA", "LA", "P"])
def test_transparency_is_laid_on_white(tmp_path: Path, mode: str) -> None:
    image = Image.new("RGBA", (4, 2), (0, 0, 0, 255))
    image.putpixel((0, 0), (0, 0, 0, 0))
    image = image.convert(mode)
    read = read_photo(save_image(image, tmp_path / "a.png"))
    assert read[0, 0].tolist() == [255, 255, 255]
    assert read[1, 3].tolist() == [0, 0, 0]


def test_half_transparency_is_half_white() -> None:
    image = Image.new("RGBA", (2, 2), (100, 0, 200, 128))
    np.testing.assert_allclose(read_photo(image)[0, 0], [177, 127, 227], atol=1)


@pytest.mark.parametrize(
    ("mode", "suffix"), [("L", "png"), ("1", "png"), ("P", "gif"), ("CMYK", "tif"), ("L", "jpg")]
)
def test_other_modes_keep_their_colour(tmp_path: Path, mode: str, suffix: str) -> None:
    white, black = Image.new("RGB", (8, 8), "white"), Image.new("RGB", (8, 8), "black")
    for image, value in ((white, 255), (black, 0)):
        read = read_photo(save_image(image.convert(mode), tmp_path / f"a.{suffix}"))
        assert read.shape == (8, 8, 3)
        np.testing.assert_allclose(read, value, atol=2)


def test_cmyk_jpeg_is_inverted_if_adobe_wrote_it(tmp_path: Path) -> None:
    image = Image.new("CMYK", (16, 16), (0, 255, 255, 0))
    path = save_image(image, tmp_path / "a.jpg", quality=100)
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
    read = read_photo(save_image(Image.fromarray(grey), tmp_path / f"a.{suffix}"))
    np.testing.assert_array_equal(read[0, :, 1], [0, 1, 128, 255])


def test_16_bit_rgb_png_is_read() -> None:
    row = b"\0" + struct.pack(">6H", 0, 32896, 65535, 65535, 257, 0)
    read = read_photo(io.BytesIO(encode_png(2, 1, 16, 2, row)))
    np.testing.assert_array_equal(read, [[[0, 128, 255], [255, 1, 0]]])


@pytest.mark.parametrize("dtype", [np.float32, np.int32])
def test_pixels_without_a_known_white_are_refused(tmp_path: Path, dtype: type) -> None:
    path = save_image(Image.fromarray(np.ones((4, 4), dtype)), tmp_path / "a.tif")
    with pytest.raises(InputError, match=r"a\.tif has pixels of Pillow's mode [FI], .* sRGB"):
        read_photo(path)


@pytest.mark.parametrize("suffix", ["jpg", "png", "webp", "tif", "bmp"])
def test_a_truncated_picture_is_refused(tmp_path: Path, suffix: str) -> None:
    noise = np.random.default_rng(0).integers(0, 255, (64, 64, 3), np.uint8)
    path = save_image(Image.fromarray(noise), tmp_path / f"a.{suffix}")
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])
    with pytest.raises(InputError, match=rf"a\.{suffix} is (damaged|not a picture)"):
        read_photo(path)


@pytest.mark.parametrize(("width", "height"), [(10_001, 10_000), (60_000, 60_000)])
def test_too_many_pixels_are_refused_by_the_header(width: int, height: int) -> None:
    limit = Image.MAX_IMAGE_PIXELS
    with pytest.raises(InputError, match=r"more pixels than the limit of 100,000,000; scale it"):
        read_photo(io.BytesIO(encode_png(width, height, 8, 2, b"\0")))
    assert limit == Image.MAX_IMAGE_PIXELS


def test_pictures_up_to_the_limit_are_read_without_a_warning(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(Image, "MAX_IMAGE_PIXELS", 20)  # Pillow warns from here on
    assert read_photo(io.BytesIO(encode_png(5, 5, 8, 0, b"\0\1\2\3\4\5" * 5))).shape == (5, 5, 3)


def test_large_arrays_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(_decode, "MAX_PIXELS", 8)
    with pytest.raises(InputError, match="3 x 3, more pixels than the limit of 8"):
        read_photo(np.zeros((3, 3), np.uint8))


@pytest.mark.parametrize("kind", ["WEBP", "AVIF", "JPEG2000", "GIF", "BMP", "PNG", "JPEG"])
def test_a_picture_that_is_cut_short_is_called_so(tmp_path: Path, kind: str) -> None:
    whole = io.BytesIO()
    pixels = np.random.default_rng(0).integers(0, 256, (40, 40, 3), np.uint8)
    Image.fromarray(pixels).save(whole, kind)
    for share in (0.05, 0.3, 0.5):
        content = whole.getvalue()[: max(int(share * len(whole.getvalue())), 30)]
        with pytest.raises(InputError, match="damaged or cut short"):
            read_picture(io.BytesIO(content), "a.picture")


def test_a_few_bytes_that_state_many_pixels_are_not_decoded() -> None:
    flat = io.BytesIO()
    Image.new("RGB", (3000, 2000), (200, 150, 120)).save(flat, "WEBP", lossless=True)
    with pytest.raises(InputError, match="states 6 megapixels in 0 KB"):
        read_picture(io.BytesIO(flat.getvalue()), "flat.webp")
