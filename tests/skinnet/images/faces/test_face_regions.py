from itertools import combinations

import numpy as np
import pytest

from skinnet.images import find_faces
from skinnet.images.faces._face_regions import REGION_NAMES, locate_region

_LEAST_IOU = {"eyelids": 0.4, "lips": 0.5}
"""Of two finds of a region that is a few pixels wide."""


def mask(landmarks: np.ndarray, name: str, size: int = 512) -> np.ndarray:
    patch = locate_region(landmarks, name).clip(size, size)
    inside = np.zeros((size, size), bool)
    inside[patch.box.slices] = patch.inside
    return inside


def compute_iou(a: np.ndarray, b: np.ndarray) -> float:
    return float((a & b).sum() / (a | b).sum())


def swap_sides(name: str) -> str:
    swapped = {"left_cheek": "right_cheek", "right_cheek": "left_cheek"}
    return swapped.get(name, name)


@pytest.fixture(scope="module")
def landmarks(astronaut: np.ndarray) -> np.ndarray:
    return find_faces(astronaut)[0].landmarks


def test_no_two_regions_share_more_than_an_edge(landmarks: np.ndarray) -> None:
    regions = {name: mask(landmarks, name) for name in REGION_NAMES}
    for one, other in combinations(regions, 2):
        assert (regions[one] & regions[other]).sum() <= 3, (one, other)


def test_regions_lie_where_their_names_say(landmarks: np.ndarray) -> None:
    x, y = np.stack([np.argwhere(mask(landmarks, name)).mean(0)[::-1] for name in REGION_NAMES], -1)
    row, column = dict(zip(REGION_NAMES, y, strict=True)), dict(zip(REGION_NAMES, x, strict=True))
    order = ("forehead", "eyelids", "nose", "lips", "chin", "neck")
    assert sorted(order, key=row.__getitem__) == list(order)
    # The person's left is at the right of the picture.
    assert column["right_cheek"] < column["nose"] < column["left_cheek"]


def test_sides_swap_in_a_mirrored_picture(astronaut: np.ndarray, landmarks: np.ndarray) -> None:
    (mirrored,) = find_faces(np.ascontiguousarray(astronaut[:, ::-1]))
    for name in REGION_NAMES:
        again = mask(mirrored.landmarks, swap_sides(name))[:, ::-1]
        assert compute_iou(mask(landmarks, name), again) > _LEAST_IOU.get(name, 0.7)


def test_regions_turn_with_the_picture(astronaut: np.ndarray, landmarks: np.ndarray) -> None:
    (turned,) = find_faces(np.ascontiguousarray(np.rot90(astronaut)))
    for name in REGION_NAMES:
        again = np.rot90(mask(turned.landmarks, name), -1)
        assert compute_iou(mask(landmarks, name), again) > _LEAST_IOU.get(name, 0.7)


@pytest.mark.parametrize(("side", "away"), [("left", "right"), ("right", "left")])
@pytest.mark.parametrize("width", [0.2, -0.5])
def test_a_cheek_that_is_turned_away_has_no_pixels(
    landmarks: np.ndarray, side: str, away: str, width: float
) -> None:
    turned = landmarks.copy()
    middle = turned[4, 0]  # the tip of the nose
    far = turned[:, 0] < middle if away == "right" else turned[:, 0] > middle
    turned[far, 0] = middle + width * (turned[far, 0] - middle)
    assert not locate_region(turned, f"{away}_cheek").inside.any()
    np.testing.assert_array_equal(mask(turned, f"{side}_cheek"), mask(landmarks, f"{side}_cheek"))
    columns = np.nonzero(mask(turned, "eyelids"))[1]
    assert (columns > middle).all() if side == "left" else (columns < middle).all()
