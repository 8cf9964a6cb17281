from pathlib import Path

import numpy as np
import pytest

from skinnet.images import Face, find_faces, read_photo, resize
from skinnet.images._face_skin import segment_face_skin
from skinnet.images.faces._face_zones import grow, mark_zones


def make_prior(face: Face, photo: np.ndarray) -> np.ndarray:
    """The face's outline and its neck, at the size of a network's mask."""
    zones = mark_zones(face.landmarks, photo.shape)
    return resize((zones.face | zones.neck).astype(np.float32), 160, 160)


def segment(photo: np.ndarray) -> tuple[Face, np.ndarray]:
    face = find_faces(photo)[0]
    return face, segment_face_skin(photo, face.landmarks, make_prior(face, photo))


def test_skin_is_skin_and_the_rest_is_not(astronaut: np.ndarray) -> None:
    face, mask = segment(astronaut)
    zones = mark_zones(face.landmarks, astronaut.shape)
    assert mask.shape == (512, 512) and mask.dtype == np.float32
    assert mask.min() >= 0 and mask.max() <= 1
    cheeks_and_nose = [(135, 200), (135, 245), (125, 224), (90, 210)]
    assert all(mask[place] > 0.9 for place in cheeks_and_nose)
    assert mask[zones.eyes].mean() < 0.2 and mask[zones.mouth].mean() < 0.3
    elsewhere = [(60, 180), (40, 230), (300, 200), (450, 380)]
    assert all(mask[place] == 0 for place in elsewhere)


def test_holes_of_the_coarse_mask_are_filled(astronaut: np.ndarray) -> None:
    face, whole = segment(astronaut)
    prior = make_prior(face, astronaut)
    prior[40:46, 60:66] = 0
    prior[30:33, 70:75] = 0
    mask = segment_face_skin(astronaut, face.landmarks, prior)
    assert np.abs(mask - whole)[mark_zones(face.landmarks, mask.shape).face].mean() < 0.01


def test_islands_of_the_coarse_mask_are_left_out(astronaut: np.ndarray) -> None:
    face, whole = segment(astronaut)
    prior = make_prior(face, astronaut)
    prior[100:103, 20:23] = 1
    mask = segment_face_skin(astronaut, face.landmarks, prior)
    assert mask[300:340, 50:90].max() == 0 and whole[300:340, 50:90].max() == 0


@pytest.mark.parametrize("name", ["043", "061", "132", "173"])
def test_faces_of_all_tones_have_no_holes(shared_data: Path, name: str) -> None:
    photo = read_photo(shared_data / "faces" / "london" / f"{name}_03.jpg")
    face, mask = segment(photo)
    zones = mark_zones(face.landmarks, photo.shape)
    parts = zones.eyes | zones.brows | zones.mouth | zones.nostrils
    bare = grow(zones.face, -0.05 * face.box.width) & ~grow(parts, 0.04 * face.box.width)
    assert mask[bare].mean() > 0.98
    assert mask[:100].max() == 0


def test_a_dense_beard_is_no_skin(shared_data: Path) -> None:
    photo = read_photo(shared_data / "faces" / "london" / "037_03.jpg")
    face, mask = segment(photo)
    x, y = face.landmarks[[152, 200]].mean(0).round().astype(int)
    assert mask[y - 20 : y + 20, x - 40 : x + 40].mean() < 0.1


def test_cloth_of_the_colour_of_skin_is_no_skin(shared_data: Path) -> None:
    photo = read_photo(shared_data / "faces" / "london" / "001_03.jpg").copy()
    face = find_faces(photo)[0]
    zones = mark_zones(face.landmarks, photo.shape)
    photo[zones.cloth] = np.median(photo[zones.face], 0) + np.array([12, 4, -6])
    _, mask = segment(photo)
    assert mask[zones.cloth].mean() < 0.1
    assert mask[grow(zones.face & ~zones.cloth & ~zones.eyes & ~zones.brows, -8.0)].mean() > 0.9
