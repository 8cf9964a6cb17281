from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from skinnet.errors import InputError
from skinnet.inference._edit_mask import check_edit_mask, read_edit_mask
from skinnet.inference._editing import to_share

RAMP = np.linspace(0, 255, 12).astype(np.uint8).reshape(3, 4)


def save(path: Path, mode: str = "L", **options: object) -> Path:
    Image.fromarray(RAMP).convert(mode).save(path, **options)
    return path


@pytest.mark.parametrize("name", ["a.png", "a.tif", "a.bmp"])
@pytest.mark.parametrize("mode", ["L", "RGB", "P"])
def test_greys_are_read_as_they_are_stored(tmp_path: Path, name: str, mode: str) -> None:
    np.testing.assert_array_equal(read_edit_mask(save(tmp_path / name, mode)), RAMP)


def test_sixteen_bits_are_kept(tmp_path: Path) -> None:
    deep = RAMP.astype(np.uint16) * 257 // 2
    Image.fromarray(deep).save(tmp_path / "a.png")
    np.testing.assert_array_equal(read_edit_mask(tmp_path / "a.png"), deep)


def test_black_and_white_are_read(tmp_path: Path) -> None:
    assert set(np.unique(read_edit_mask(save(tmp_path / "a.png", "1")))) == {0, 255}


def test_a_grey_jpeg_is_read(tmp_path: Path) -> None:
    Image.fromarray(RAMP).convert("RGB").save(tmp_path / "a.jpg", quality=95)
    assert np.abs(read_edit_mask(tmp_path / "a.jpg").astype(int) - RAMP).max() < 8


def test_what_is_transparent_is_black(tmp_path: Path) -> None:
    alpha = np.full(RAMP.shape, 255, np.uint8)
    alpha[1], alpha[2] = 0, 128
    Image.fromarray(np.dstack([RAMP, alpha]), "LA").save(tmp_path / "a.png")
    read = read_edit_mask(tmp_path / "a.png")
    np.testing.assert_array_equal(read[0], RAMP[0])
    assert (read[1] == 0).all()
    np.testing.assert_array_equal(read[2], np.rint(RAMP[2] * (128 / 255)))


def test_colours_that_are_transparent_do_not_count(tmp_path: Path) -> None:
    pixels = np.full((3, 4, 4), 255, np.uint8)
    pixels[0] = 255, 0, 0, 0
    Image.fromarray(pixels).save(tmp_path / "a.png")
    assert read_edit_mask(tmp_path / "a.png")[:, 0].tolist() == [0, 255, 255]


def test_a_mask_is_turned_upright(tmp_path: Path) -> None:
    exif = Image.Exif()
    exif[0x0112] = 6
    read = read_edit_mask(save(tmp_path / "a.png", exif=exif))
    np.testing.assert_array_equal(read, np.rot90(RAMP, -1))


def test_coloured_masks_are_refused(tmp_path: Path) -> None:
    Image.new("RGB", (4, 3), (255, 0, 0)).save(tmp_path / "a.png")
    with pytest.raises(InputError, match=r"a\.png is coloured, and a mask is grey\. White is"):
        read_edit_mask(tmp_path / "a.png")
    Image.new("CMYK", (4, 3)).save(tmp_path / "a.tif")
    with pytest.raises(InputError, match="is CMYK"):
        read_edit_mask(tmp_path / "a.tif")


@pytest.mark.parametrize(
    ("values", "words"),
    [
        (np.zeros((3, 4), np.uint8), "is black everywhere"),
        (np.eye(3, 4, dtype=np.uint8), r"largest value is 1 of 255.*by 255 if 1 means"),
        (np.eye(3, 4).astype(np.uint16) * 255, r"largest value is 255 of 65535.*by 257 if"),
    ],
)
def test_masks_without_an_edit_are_refused(tmp_path: Path, values: np.ndarray, words: str) -> None:
    Image.fromarray(values).save(tmp_path / "a.png")
    with pytest.raises(InputError, match=words):
        read_edit_mask(tmp_path / "a.png")


def test_standard_input_is_for_the_photograph() -> None:
    with pytest.raises(InputError, match="--mask takes a file"):
        read_edit_mask(Path("-"))


def test_a_mask_that_is_no_picture_is_named(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"There is no file .*a\.png"):
        read_edit_mask(tmp_path / "a.png")


@pytest.mark.parametrize(
    ("mask", "words"),
    [
        (np.ones((3, 4, 1)), r"A mask is \[H, W\]; got shape \[3, 4, 1\]"),
        (np.ones((6, 8)), "The mask has 8 x 6 pixels, and a.jpg 4 x 3; give a mask of"),
        (np.ones((4, 3)), "turned it upright; turn the mask too"),
        (np.ones((3, 4), int), "got int64"),
        (np.full((3, 4), 1.5), r"lies in \[0, 1\]; got 1.5"),
        (np.full((3, 4), np.nan), "got nan"),
        (np.eye(3, 4, dtype=np.uint8), "The mask is nearly black"),
    ],
)
def test_arrays_that_are_no_masks_are_refused(mask: np.ndarray, words: str) -> None:
    with pytest.raises(InputError, match=words):
        check_edit_mask(mask, (3, 4, 3), "a.jpg")


@pytest.mark.parametrize(
    "mask",
    [
        np.array([[True, False]]),
        np.array([[255, 0]], np.uint8),
        np.array([[65535, 0]], np.uint16),
        np.array([[1.0, 0.0]]),
        [[1.0, 0.0]],
    ],
)
def test_shares_are_of_white(mask: object) -> None:
    assert to_share(check_edit_mask(mask, (1, 2, 3), "a.jpg")).tolist() == [[1, 0]]
    assert to_share(np.array([51], np.uint8)).tolist() == pytest.approx([0.2])
