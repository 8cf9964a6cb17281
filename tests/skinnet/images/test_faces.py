import csv
from pathlib import Path

import numpy as np
import pytest
from skimage import data

from skinnet.images import Box, find_face, frame_head, read_photo, resize

FACE = Box(176, 71, 268, 163)


def compute_iou(a: Box, b: Box) -> float:
    width = min(a.right, b.right) - max(a.left, b.left)
    height = min(a.bottom, b.bottom) - max(a.top, b.top)
    shared = max(width, 0) * max(height, 0)
    return shared / (a.width * a.height + b.width * b.height - shared)


def test_the_astronaut_is_found(astronaut: np.ndarray) -> None:
    face = find_face(astronaut)
    assert face is not None
    assert compute_iou(face, FACE) > 0.7


@pytest.mark.parametrize("factor", [0.5, 4])
def test_a_face_is_found_at_any_size(astronaut: np.ndarray, factor: float) -> None:
    side = round(512 * factor)
    face = find_face(resize(astronaut, side, side))
    assert face is not None
    assert compute_iou(face, Box(*(round(value * factor) for value in FACE))) > 0.6


def test_the_largest_central_face_is_taken(astronaut: np.ndarray) -> None:
    small = resize(astronaut, 256, 256)
    scene = np.full((512, 768, 3), 128, np.uint8)
    scene[:256, :256], scene[:, 256:] = small, astronaut
    face = find_face(scene)
    assert face is not None
    assert compute_iou(face, Box(FACE.left + 256, FACE.top, FACE.right + 256, FACE.bottom)) > 0.6


@pytest.mark.parametrize("shape", [(1, 1), (3, 900), (40, 30), (300, 400)])
def test_no_face_is_none(shape: tuple[int, int]) -> None:
    assert find_face(np.full((*shape, 3), 200, np.uint8)) is None


@pytest.mark.parametrize("name", ["coffee", "rocket", "brick", "gravel", "coins", "moon"])
def test_no_face_is_found_in_things(name: str) -> None:
    assert find_face(read_photo(getattr(data, name)())) is None


@pytest.mark.parametrize("side", [200, 1000])
def test_no_face_is_found_in_noise(side: int) -> None:
    noise = np.random.default_rng(0).integers(0, 255, (side, side, 3), np.uint8)
    assert find_face(noise) is None


def test_the_crop_is_square_and_holds_the_head() -> None:
    crop = frame_head(FACE, 512, 512)
    assert crop.width == crop.height == 184
    # Hair starts a fifth of a face above the box, and the chin ends just under it.
    assert crop.top < FACE.top - 0.2 * 92 and crop.bottom > FACE.bottom + 0.1 * 92


def test_the_crop_stays_inside_the_picture() -> None:
    assert frame_head(Box(-3, -2, 90, 91), 100, 80) == Box(0, 0, 100, 80)


@pytest.mark.slow
def test_portraits_are_found(shared_data: Path) -> None:
    folder = shared_data / "faces" / "congress"
    with (folder / "index.csv").open() as file:
        rows = list(csv.DictReader(file))[::20]
    found = 0
    for row in rows:
        x, y, width, height = (int(row[f"face_{key}"]) for key in "xywh")
        face = find_face(read_photo(folder / row["file"]))
        found += face is not None and compute_iou(face, Box(x, y, x + width, y + height)) > 0.4
    assert found >= 0.95 * len(rows)
