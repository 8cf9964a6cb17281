"""Arrays and tensors are read alike, and what could mean several things is refused."""

from io import BytesIO
from pathlib import Path

import numpy as np
import pytest
import torch
from PIL import Image

from skinnet.errors import InputError
from skinnet.images import linear_to_srgb, read_photo, read_picture, srgb_to_linear


@pytest.fixture(scope="module")
def photo() -> np.ndarray:
    return np.random.default_rng(0).integers(0, 256, (11, 17, 3), np.uint8)


def test_every_kind_of_array_is_the_same_picture(photo: np.ndarray) -> None:
    tensor = torch.tensor(photo).permute(2, 0, 1)
    deep = photo.astype(np.uint16) * 257
    for same in (
        *(photo, deep, deep.astype(">u2"), photo / 255, (photo / 255).astype(np.float16)),
        *(tensor, tensor / 255, (tensor / 255).requires_grad_(), (tensor / 255).half()),
        np.ma.array(photo),
    ):
        np.testing.assert_array_equal(read_photo(same), photo)
    near = read_photo((tensor / 255).bfloat16())
    assert np.abs(near.astype(int) - photo).max() <= 1  # 8 bits of mantissa


def test_grey_and_alpha_are_read_from_tensors(photo: np.ndarray) -> None:
    grey = torch.tensor(photo[..., 0])
    for same in (grey, grey[None]):
        np.testing.assert_array_equal(read_picture(same).pixels, photo[..., 0])
    alpha = np.arange(187, dtype=np.uint8).reshape(11, 17)
    both = torch.tensor(np.dstack([photo, alpha])).permute(2, 0, 1)
    read = read_picture(both)
    np.testing.assert_array_equal(read.pixels, photo)
    np.testing.assert_array_equal(read.alpha, alpha)


def test_bytes_and_open_files_are_read(photo: np.ndarray, tmp_path: Path) -> None:
    path = tmp_path / "a.png"
    Image.fromarray(photo).save(path)
    content = path.read_bytes()
    with path.open("rb") as file:
        sources = (content, bytearray(content), memoryview(content), BytesIO(content), file)
        for source in (*sources, read_picture(path)):
            np.testing.assert_array_equal(read_photo(source), photo)
    assert read_picture(read_picture(path), "b").name == "b"


def test_floats_keep_their_depth() -> None:
    ramp = np.linspace(0, 1, 60000, dtype=np.float32).reshape(100, 200, 3)
    read = read_picture(ramp)
    assert read.pixels.dtype == np.uint16
    assert np.abs(read.pixels / 65535 - ramp).max() < 0.51 / 65535
    np.testing.assert_allclose(read.linear(), srgb_to_linear(ramp), atol=2e-5)


def test_a_copy_is_kept(photo: np.ndarray) -> None:
    for given in (photo.copy(), photo.astype(np.uint16) * 257):
        read = read_picture(given)
        given[:] = 7
        np.testing.assert_array_equal(read.srgb, photo)


def test_linear_light_is_encoded(photo: np.ndarray) -> None:
    read = read_picture(srgb_to_linear(photo), colour_space="linear sRGB")
    assert read.colour_space == ("sRGB", "argument", None)
    assert np.abs(read.srgb.astype(int) - photo).max() == 0
    with_alpha = np.dstack([photo, photo[..., 0]])
    read = read_picture(with_alpha, colour_space="Linear SRGB")
    expected = linear_to_srgb(photo / np.float32(255))
    np.testing.assert_allclose(read.pixels / 65535, expected, atol=1e-4)
    np.testing.assert_array_equal(read.alpha, photo[..., 0].astype(np.uint16) * 257)


def test_a_stated_space_is_converted(photo: np.ndarray) -> None:
    read = read_picture(photo, colour_space="Display P3")
    again = read_picture(read.pixels, colour_space=read.colour_space)
    np.testing.assert_array_equal(read.srgb, again.srgb)
    red = np.array([[[200, 90, 80]]], np.uint8)
    assert read_picture(red, colour_space="Adobe RGB (1998)").srgb[0, 0, 0] > 215
    with pytest.raises(InputError, match=r"colour_space is linear sRGB, sRGB, .* got 'P4'"):
        read_picture(photo, colour_space="P4")
    with pytest.raises(InputError, match="is for arrays and tensors; a file"):
        read_picture(Image.fromarray(photo), colour_space="sRGB")


def test_values_of_twelve_bits_are_noted(photo: np.ndarray) -> None:
    read = read_picture(photo.astype(np.uint16) * 16)
    assert "If its white is 4095, multiply it by 16" in read.notes[0]
    read = read_picture(photo.astype(np.uint16) * 4)
    assert "If its white is 1023, multiply it by 64" in read.notes[0]


@pytest.mark.parametrize(
    ("shape", "words"),
    [
        ((5, 6, 3), r"got shape \[5, 6, 3\]\. Put the channels first: tensor\.permute\(2, 0, 1\)"),
        ((3, 6, 3), r"\[3, 6, 3\] could be \[3, H, W\] or \[H, W, 3\]"),
        ((2, 3, 6, 6), r"A tensor of one image is \[3, H, W\].* Decomposer takes it"),
        ((2, 6, 6), r"got shape \[2, 6, 6\]"),
        ((6,), r"got shape \[6\]"),
    ],
)
def test_other_tensors_are_refused(shape: tuple[int, ...], words: str) -> None:
    with pytest.raises(InputError, match=words):
        read_picture(torch.zeros(shape))


def test_tensors_without_values_are_refused() -> None:
    for tensor in (torch.zeros(3, 6, 6).to_sparse(), torch.zeros(3, 6, 6, device="meta")):
        with pytest.raises(InputError, match=r"A tensor of the type torch\.float32 cannot be read"):
            read_picture(tensor)
    with pytest.raises(InputError, match="got complex64"):
        read_picture(torch.zeros(3, 6, 6, dtype=torch.complex64))


def test_files_that_give_no_bytes_are_refused(tmp_path: Path) -> None:
    finished = BytesIO(b"abc")
    finished.read()
    with pytest.raises(InputError, match="to its end before; call its seek"):
        read_picture(finished)
    finished.close()
    with pytest.raises(InputError, match=r"cannot be read .*closed file"):
        read_picture(finished)
