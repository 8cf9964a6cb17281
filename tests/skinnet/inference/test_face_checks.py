from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from painted_skin import compress_jpeg
from PIL import Image, ImageDraw
from skimage.data import astronaut

from skinnet.errors import InputError
from skinnet.images import (
    Face,
    find_faces,
    linear_to_srgb,
    read_photo,
    resize,
    srgb_to_linear,
    to_uint8,
)
from skinnet.inference._face_checks import check_face
from skinnet.inference._head_crop import crop_head

FACES = Path("../shared/data/faces")
HEAD = np.ascontiguousarray(astronaut()[40:200, 144:304])


def check(photo: np.ndarray) -> tuple[str, ...]:
    (face,) = find_faces(photo)
    return check_face(photo, crop_head(face, photo.shape), face, "The face in a.jpg", "a.jpg")


def draw(skin: tuple[int, int, int], size: int = 300, shade: float = 0.0) -> np.ndarray:
    """Draw a face in a few colours; `shade` is a gradient over it, in shares of its brightness."""
    image = Image.new("RGB", (400, 400), (120, 190, 240))
    pen = ImageDraw.Draw(image)
    pen.rectangle((160, 300, 240, 400), skin)
    pen.ellipse((68, 24, 332, 312), (90, 50, 20))
    pen.ellipse((88, 72, 312, 344), skin, (20, 20, 20), 3)
    for x in (152, 248):
        pen.ellipse((x - 24, 178, x + 24, 206), "white", (20, 20, 20), 2)
        pen.ellipse((x - 11, 180, x + 11, 204), (70, 110, 60))
        pen.ellipse((x - 5, 186, x + 5, 198), "black")
        pen.arc((x - 32, 144, x + 32, 184), 200, 340, (60, 30, 10), 7)
    pen.line((200, 192, 188, 248, 208, 252), (120, 80, 60), 4)
    pen.ellipse((164, 276, 236, 294), (200, 60, 70))
    gradient = np.linspace(1 + shade, 1 - shade, 400)[None, :, None]
    return resize((np.array(image) * gradient).clip(0, 255).astype(np.uint8), size, size)


@pytest.mark.parametrize("size", [150, 300, 800])
@pytest.mark.parametrize("skin", [(230, 170, 130), (190, 125, 85), (130, 80, 55)])
def test_drawings_are_refused(skin: tuple[int, int, int], size: int) -> None:
    with pytest.raises(InputError, match=r"The face in a\.jpg seems to be drawn: \d\d% of it has"):
        check(draw(skin, size))


def test_drawings_in_jpeg_are_refused() -> None:
    with pytest.raises(InputError, match="seems to be drawn"):
        check(compress_jpeg(draw((190, 125, 85), 600), 60))


def darken(photo: np.ndarray, factor: float) -> np.ndarray:
    return to_uint8(linear_to_srgb(srgb_to_linear(photo) * np.float32(factor)))


@pytest.mark.parametrize(
    "change",
    [
        lambda photo: photo,
        lambda photo: compress_jpeg(photo, 10),
        lambda photo: darken(photo, 0.05),
        lambda photo: darken(photo, 2.0),
        lambda photo: resize(resize(photo, 60, 60), 300, 300),
    ],
)
def test_photographs_are_not(change: Callable[[np.ndarray], np.ndarray]) -> None:
    assert check(change(HEAD)) == ()


@pytest.mark.skipif(not FACES.is_dir(), reason="needs ../shared/data/faces")
def test_portraits_are_not() -> None:
    paths = sorted(FACES.glob("congress/*.jpg"))[::24] + sorted(FACES.glob("london/*.jpg"))[::12]
    for path in paths:
        assert check(read_photo(path)) == (), path


def test_small_faces_are_refused_with_their_size() -> None:
    small = np.full((128, 128, 3), 128, np.uint8)
    small[48:80, 48:80] = resize(HEAD, 32, 32)
    (face,) = find_faces(small)
    width = face.box.width
    assert 16 < width < 24
    with pytest.raises(InputError, match=rf"is {width} pixels wide, and 24 are needed; give"):
        check(small)


def check_part(left: int) -> tuple[str, ...]:
    """Check the face of a photograph whose left columns, up to one of the face, are cut off."""
    (face,) = find_faces(HEAD)
    start = face.box.left + left
    photo = np.ascontiguousarray(HEAD[:, start:])
    box = face.box._replace(left=face.box.left - start, right=face.box.right - start)
    part = Face(box, face.tilt, face.score, face.landmarks)
    return check_face(photo, crop_head(part, photo.shape), part, "The face in a.jpg", "a.jpg")


def test_a_face_at_the_edge_is_read_with_a_note() -> None:
    assert check_part(8) == ()
    (note,) = check_part(44)
    assert note.startswith("The face in a.jpg is only 60% inside the picture; its means are")


def test_half_a_face_is_needed() -> None:
    with pytest.raises(InputError, match=r"only 41% inside the picture, and half of it is needed"):
        check_part(65)
