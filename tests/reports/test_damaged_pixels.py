"""Pictures whose pixels are damaged or few in colours are not read in silence."""

import io

import numpy as np
import pytest
from PIL import Image
from skimage.data import astronaut

from skinnet.errors import InputError
from skinnet.images import read_picture


def encode(image: Image.Image, kind: str) -> bytes:
    file = io.BytesIO()
    image.save(file, kind)
    return file.getvalue()


@pytest.mark.parametrize("place", [0.2, 0.5, 0.9])
@pytest.mark.parametrize("depth", [8, 16])
def test_a_png_with_a_changed_byte_is_damaged(place: float, depth: int) -> None:
    if depth == 8:
        content = bytearray(encode(Image.fromarray(astronaut()), "PNG"))
    else:
        from imagecodecs import png_encode

        content = bytearray(png_encode(astronaut().astype(np.uint16) * 257))
    content[int(place * len(content))] ^= 0x55
    with pytest.raises(InputError, match="a is damaged or cut short"):
        read_picture(io.BytesIO(bytes(content)), "a")


@pytest.mark.parametrize("kind", ["PNG", "GIF", "BMP", "TIFF"])
def test_a_palette_is_said(kind: str) -> None:
    content = encode(Image.fromarray(astronaut()).quantize(64), kind)
    (note,) = read_picture(io.BytesIO(content), "a").notes
    assert note.startswith("a has a palette of at most 256 colours")


def test_a_sound_png_has_no_note() -> None:
    picture = read_picture(io.BytesIO(encode(Image.fromarray(astronaut()), "PNG")))
    assert picture.notes == ()
    np.testing.assert_array_equal(picture.srgb, astronaut())
