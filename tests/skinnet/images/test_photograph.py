import io
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from picture_files import make_photo, make_srgb_profile, save_image
from PIL import Image

from skinnet.errors import InputError
from skinnet.images import read_photo


@pytest.mark.parametrize("suffix", ["png", "bmp", "tif", "webp", "ppm", "gif"])
def test_lossless_formats_read_back_the_same(tmp_path: Path, suffix: str) -> None:
    photo = make_photo()
    path = save_image(Image.fromarray(photo), tmp_path / f"a.{suffix}", lossless=True)
    np.testing.assert_array_equal(read_photo(path), photo)


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


def test_a_folder_and_a_name_that_cannot_be_are_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="is a folder; give a photograph in it"):
        read_photo(tmp_path)
    with pytest.raises(InputError, match="cannot be read"):
        read_photo("a\0b.jpg")


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
    np.testing.assert_array_equal(read_photo(array), np.full((4, 5, 3), 128))


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
        (np.zeros((4, 4, 3), bool), r"got bool\. A mask is no photograph"),
        (np.zeros((4, 4, 3), complex), r"got complex128"),
        (np.zeros((4, 4, 3), object), r"got object\. Give the images as a list"),
        (np.full((4, 4, 3), 255, np.uint16), r"largest value of this one is 255\. If its white"),
        (np.full((4, 4, 3), 1 / 255**2), r"Was it divided by 255 twice\?"),
        (np.zeros((3, 5, 5), np.uint8), r"Put the channels last: array\.transpose\(1, 2, 0\)"),
        (np.ones((4, 4)).view(np.matrix), r"not an np\.matrix; give np\.asarray"),
        (np.ma.masked_less(np.ones((4, 4)), 2), r"has masked values"),
    ],
)
def test_other_arrays_are_refused(array: np.ndarray, words: str) -> None:
    with pytest.raises(ValueError, match=words):
        read_photo(array)


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


def read_or_explain(content: bytes) -> tuple[np.ndarray | None, str]:
    try:
        return read_photo(io.BytesIO(content)), ""
    except InputError as error:
        return None, str(error)


@given(data=st.data(), kind=st.sampled_from(["PNG", "JPEG", "TIFF", "WEBP", "GIF", "BMP"]))
def test_damage_gives_a_photograph_or_a_sentence(data: st.DataObject, kind: str) -> None:
    buffer = io.BytesIO()
    exif = Image.Exif()
    exif[0x0112] = 6
    image = Image.fromarray(make_photo(12, 16))
    image.save(buffer, kind, exif=exif, icc_profile=make_srgb_profile())
    content = bytearray(buffer.getvalue())
    for at in data.draw(st.lists(st.integers(0, len(content) - 1), max_size=6)):
        content[at] = data.draw(st.integers(0, 255))
    cut = data.draw(st.integers(0, len(content)))
    photo, sentence = read_or_explain(bytes(content[:cut]))
    if photo is None:
        assert sentence.endswith((".", "?"))
    else:
        assert photo.dtype == np.uint8 and photo.ndim == 3 and photo.shape[2] == 3
