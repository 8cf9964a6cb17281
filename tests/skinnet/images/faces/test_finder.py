import csv
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from skimage import data

from skinnet.images import Box, Face, find_faces, read_photo, resize
from skinnet.images.faces._largest import choose_largest

FACE = Box(170, 59, 279, 168)


def compute_iou(a: Box, b: Box) -> float:
    width = min(a.right, b.right) - max(a.left, b.left)
    height = min(a.bottom, b.bottom) - max(a.top, b.top)
    shared = max(width, 0) * max(height, 0)
    return shared / (a.width * a.height + b.width * b.height - shared)


def find_only(photo: np.ndarray) -> Face:
    (face,) = find_faces(photo)
    return face


def test_the_astronaut_is_found(astronaut: np.ndarray) -> None:
    face = find_only(astronaut)
    assert compute_iou(face.box, FACE) > 0.9
    assert abs(face.tilt) < 6 and face.score > 0.99


@pytest.mark.parametrize("factor", [0.2, 0.5, 4])
def test_a_face_is_found_at_any_size(astronaut: np.ndarray, factor: float) -> None:
    side = round(512 * factor)
    face = find_only(resize(astronaut, side, side))
    assert compute_iou(face.box, Box(*(round(value * factor) for value in FACE))) > 0.8


@pytest.mark.parametrize("tilt", [15, 30, 45, 90, 180, -60])
def test_a_tilted_face_is_found_with_its_tilt(astronaut: np.ndarray, tilt: int) -> None:
    upright = find_only(astronaut)
    turned = np.array(Image.fromarray(astronaut).rotate(-tilt, Image.Resampling.BICUBIC))
    face = find_only(turned)
    assert abs((face.tilt - upright.tilt - tilt + 180) % 360 - 180) < 5
    angle = np.radians(tilt)
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    expected = (upright.landmarks - 256) @ turn.T + 256
    error = np.linalg.norm(face.landmarks - expected, axis=1)
    assert np.median(error) < 0.03 * upright.box.width


def test_a_face_that_fills_the_picture_is_found(astronaut: np.ndarray) -> None:
    face = find_only(np.ascontiguousarray(astronaut[75:170, 175:275]))
    assert compute_iou(face.box, Box(-5, -16, 104, 93)) > 0.7


def test_faces_are_ordered_from_left_to_right(astronaut: np.ndarray) -> None:
    small = resize(astronaut, 256, 256)
    scene = np.full((512, 768, 3), 128, np.uint8)
    scene[:256, :256], scene[:, 256:] = small, astronaut
    first, second = find_faces(scene)
    assert first.box.left < 256 < second.box.left
    assert choose_largest([first, second]) is second


def test_small_faces_of_a_large_picture_are_found(astronaut: np.ndarray) -> None:
    small = resize(astronaut, 240, 240)[10:100, 60:150]
    scene = np.full((1600, 2000, 3), 90, np.uint8)
    for row in (100, 800, 1500):
        for column in (50, 1000, 1900):
            scene[row : row + 90, column : column + 90] = small
    assert len(find_faces(scene)) == 9


@pytest.mark.parametrize("shape", [(1, 1), (3, 900), (40, 30), (300, 400)])
def test_an_even_picture_has_no_face(shape: tuple[int, int]) -> None:
    assert find_faces(np.full((*shape, 3), 200, np.uint8)) == []


@pytest.mark.parametrize("name", ["coffee", "chelsea", "brick", "gravel", "moon", "page", "retina"])
def test_no_face_is_found_in_things_and_animals(name: str) -> None:
    assert find_faces(read_photo(getattr(data, name)())) == []


@pytest.mark.parametrize("side", [200, 1000])
def test_no_face_is_found_in_noise(side: int) -> None:
    noise = np.random.default_rng(0).integers(0, 255, (side, side, 3), np.uint8)
    assert find_faces(noise) == []


@pytest.mark.slow
def test_portraits_are_found(shared_data: Path) -> None:
    folder = shared_data / "faces" / "congress"
    with (folder / "index.csv").open() as file:
        rows = list(csv.DictReader(file))[::20]
    for row in rows:
        x, y, width, height = (int(row[f"face_{key}"]) for key in "xywh")
        face = find_only(read_photo(folder / row["file"]))
        assert compute_iou(face.box, Box(x, y, x + width, y + height)) > 0.5
