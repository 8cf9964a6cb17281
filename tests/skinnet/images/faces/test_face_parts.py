from dataclasses import replace

import numpy as np
import pytest

from skinnet.images import Face, find_faces, resize
from skinnet.images.faces._face_parts import find_face_parts
from skinnet.images.faces._face_regions import REGION_NAMES


@pytest.fixture(scope="module")
def face(astronaut: np.ndarray) -> Face:
    return find_faces(astronaut)[0]


def test_the_smile_of_the_astronaut_shows_teeth(astronaut: np.ndarray, face: Face) -> None:
    parts = find_face_parts(astronaut, face)
    (teeth,) = parts.teeth
    white, lips = (
        astronaut[patch.box.slices][patch.inside].mean(0)
        for patch in (teeth, parts.regions["lips"].patch)
    )
    assert teeth.inside.sum() >= 20
    assert (white > lips).all()
    assert parts.sclera == ()  # the eyes are 20 pixels wide


def test_sclera_is_found_in_larger_eyes(astronaut: np.ndarray) -> None:
    large = resize(astronaut, 2048, 2048)
    (face,) = find_faces(large)
    right, left = find_face_parts(large, face).sclera
    assert min(right.inside.sum(), left.inside.sum()) > 50


def test_regions_are_inside_the_photograph(astronaut: np.ndarray, face: Face) -> None:
    for region in find_face_parts(astronaut, face).regions.values():
        assert 0.95 * region.area < region.patch.inside.sum() <= region.area
    cut = np.ascontiguousarray(astronaut[: face.box.bottom])
    regions = find_face_parts(cut, face).regions
    assert tuple(regions) == REGION_NAMES
    assert not regions["neck"].patch.inside.any() and regions["neck"].area > 1000
    assert 0 < regions["chin"].patch.inside.sum() < regions["chin"].area


def test_a_grey_beard_is_no_chin(astronaut: np.ndarray, face: Face) -> None:
    bearded = astronaut.copy()
    top = round(float(face.landmarks[17, 1])) + 1  # below the lips
    beard = bearded[top : face.box.bottom + 40]
    beard[...] = beard.mean(-1, keepdims=True).astype(np.uint8)
    regions = find_face_parts(bearded, face).regions
    assert regions["chin"].patch.inside.sum() < 0.1 * regions["chin"].area
    assert regions["neck"].patch.inside.sum() < 0.1 * regions["neck"].area
    assert regions["nose"].patch.inside.sum() == regions["nose"].area


def test_a_face_outside_the_photograph_has_no_parts(astronaut: np.ndarray, face: Face) -> None:
    shifted = replace(face, landmarks=face.landmarks - np.float32([600, 0]))
    parts = find_face_parts(astronaut, shifted)
    assert all(not region.patch.inside.any() for region in parts.regions.values())
    assert not parts.sclera and not parts.teeth
