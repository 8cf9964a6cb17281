import math

import numpy as np
import pytest
from PIL import Image, ImageDraw

from skinnet.images import Box, Face, frame_head
from skinnet.inference._head_crop import HeadCrop, crop_head, crop_patch, place_face_in_cut
from skinnet.inference.onnx_model import _SD_NAMES, MAP_NAMES

SIZE = 160
LANDMARKS = np.zeros((478, 2), np.float32)

NAMES = (*MAP_NAMES, *_SD_NAMES, "mask")


def make_face(tilt: float, middle: tuple[int, int] = (200, 200), width: int = 80) -> Face:
    left, top = middle[0] - width // 2, middle[1] - width // 2
    return Face(Box(left, top, left + width, top + width), tilt, 1.0, LANDMARKS)


def make_photo() -> np.ndarray:
    """Smooth colours, so that turning them twice changes little."""
    y, x = np.mgrid[:400, :400]
    waves = [np.sin(x / 37 + k) * np.cos(y / 29 - k) for k in range(3)]
    return (127 + 120 * np.stack(waves, -1)).astype(np.uint8)


def run_encoder(cut: np.ndarray) -> dict[str, np.ndarray]:
    """Maps that are the channels of the cut."""
    maps = cut.astype(np.float32)[None] / 255
    outputs = {name: maps[..., 0] for name in NAMES}
    return outputs | {"offset": maps, "light": np.array([[0.25, 0.75]], np.float32)}


@pytest.mark.parametrize("tilt", [0.0, -8.0, 7.9])
def test_upright_heads_are_cut_as_they_are(tilt: float) -> None:
    crop = crop_head(make_face(tilt), (400, 400))
    assert crop == HeadCrop(frame_head(make_face(tilt).box, 400, 400))
    outputs = run_encoder(crop.cut(make_photo(), SIZE))
    assert crop.turn_back(outputs, SIZE) == outputs


@pytest.mark.parametrize("tilt", [15.0, -30.0, 45.0, 90.0, 180.0])
def test_maps_turned_back_lie_on_the_photograph(tilt: float) -> None:
    photo, crop = make_photo(), crop_head(make_face(tilt), (400, 400))
    assert crop.square is not None
    turned = crop.turn_back(run_encoder(crop.cut(photo, SIZE)), SIZE)
    _, height, width = turned["melanin"].shape
    assert width / height == pytest.approx(crop.box.width / crop.box.height, rel=0.02)
    here = np.array(Image.fromarray(photo[crop.box.slices]).resize((width, height)))
    inside = crop.fade((height, width), (4000, 4000)) > 0.1
    assert np.abs(turned["offset"][0] - here / 255)[inside].max() < 0.03
    np.testing.assert_array_equal(turned["light"], [[0.25, 0.75]])


def test_the_cut_is_upright() -> None:
    """A mark at the top of a head that is turned clockwise by 90 degrees is at its right."""
    photo = Image.new("RGB", (400, 400), "blue")
    ImageDraw.Draw(photo).ellipse((250, 190, 270, 210), "red")
    cut = crop_head(make_face(90.0), (400, 400)).cut(np.array(photo), SIZE)
    rows, columns = np.nonzero(cut[..., 0] > 128)
    assert columns.mean() == pytest.approx(SIZE / 2, abs=1)
    assert rows.mean() == pytest.approx(SIZE / 2 - 56, abs=1)


def test_the_mask_is_0_outside_the_turned_square() -> None:
    crop = crop_head(make_face(45.0), (400, 400))
    outputs = {name: np.ones((1, SIZE, SIZE), np.float32) for name in NAMES}
    turned = crop.turn_back(outputs, SIZE)
    assert not turned["mask"][0, 0, 0] and not turned["mask"][0, -1, -1]
    assert (turned["melanin"] == 1).all()
    assert (turned["mask"] > 0.5).mean() == pytest.approx(0.5, abs=0.02)  # half of the box


@pytest.mark.parametrize("tilt", [30.0, -90.0, 135.0])
def test_heads_at_a_corner_are_clipped(tilt: float) -> None:
    photo = make_photo()
    crop = crop_head(make_face(tilt, (15, 390)), photo.shape)
    assert crop.box.left == 0 and crop.box.bottom == 400
    cut = crop.cut(photo, SIZE)
    assert cut.shape == (SIZE, SIZE, 3) and cut.std() > 10
    weights = crop.fade((40, 50), photo.shape)
    assert weights.shape == (40, 50) and 0 <= weights.min() < weights.max() <= 1


def test_an_edit_fades_at_sides_inside_the_photograph_only() -> None:
    crop = crop_head(make_face(30.0), (400, 400))
    inside = crop.fade((100, 100), (400, 400))
    assert inside[0, 0] == 0 and inside[50, 50] == 1
    outside = HeadCrop(crop.box, crop.square).fade((100, 100), (1, 1))
    assert (outside == 1).all()


def test_the_face_is_where_the_cut_has_it() -> None:
    box = place_face_in_cut(200)
    assert box == Box(50, 55, 150, 155)
    crop = crop_head(make_face(90.0), (400, 400))
    assert crop.square is not None
    middle = crop.square.place(np.array([[100.0, 105.0]]), 200)[0]
    assert math.dist(middle, (200, 200)) < 1


def test_a_patch_is_seen_amid_its_mirror_images() -> None:
    photo = make_photo()[:200]
    crop = crop_patch(photo.shape)
    assert crop.box == Box(0, 0, 400, 200)
    cut = crop.cut(photo, SIZE)
    middle = np.array(Image.fromarray(photo).resize((80, 40)))
    assert np.abs(cut[60:100, 40:120].astype(int) - middle).max() < 12
    assert np.abs(cut[60:100, 30:40].astype(int) - cut[60:100, 49:39:-1]).max() < 12
    turned = crop.turn_back(run_encoder(cut), SIZE)
    assert turned["offset"].shape == (1, 40, 80, 3) and (turned["mask"] > 0).any()
    assert (crop.fade((40, 80), photo.shape) == 1).all()


def test_only_the_turned_square_was_read() -> None:
    crop = crop_head(make_face(30.0), (400, 400))
    inside = crop.find_inside()
    assert inside.shape == (crop.box.height, crop.box.width)
    assert np.count_nonzero(inside) == pytest.approx(160**2, rel=0.02)
    u, v = np.meshgrid(*(np.arange(side) for side in inside.shape[::-1]))
    middle = np.hypot(u - crop.box.width / 2, v - crop.box.height / 2) < 78
    assert inside[middle].all() and not inside[:3, :3].any()


@pytest.mark.parametrize(("left", "is_cut"), [(60, False), (39, False), (30, True)])
def test_a_head_whose_face_is_cut_is_continued_outside(left: int, is_cut: bool) -> None:
    face = make_face(0.0, middle=(left, 200))
    crop = crop_head(face, (400, 400))
    assert (crop.square is not None) == is_cut
    assert crop.box.left == 0 and crop.find_inside().all()
    cut = crop.cut(make_photo(), SIZE)
    assert (cut.shape[0] == cut.shape[1]) == is_cut
