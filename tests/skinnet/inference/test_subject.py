import numpy as np
import pytest

from skinnet.errors import InputError, NoFaceError
from skinnet.images import resize
from skinnet.inference._subject import find_subjects


def make_scene(astronaut: np.ndarray, *sizes: int) -> np.ndarray:
    """People of some sizes in a row, each the second one mirrored."""
    head = np.ascontiguousarray(astronaut[40:200, 144:304])
    scene = np.full((max(sizes), sum(sizes), 3), 100, np.uint8)
    left = 0
    for number, size in enumerate(sizes):
        scene[-size:, left : left + size] = resize(head[:, :: 1 - 2 * (number % 2)], size, size)
        left += size
    return scene


def test_numbers_count_all_faces(astronaut: np.ndarray) -> None:
    scene = make_scene(astronaut, 100, 200, 150)
    subjects = find_subjects(scene, "a.jpg", 2, "face")
    assert [subject.face_id for subject in subjects] == [2, 3]
    assert all(subject.faces is not None and len(subject.faces) == 3 for subject in subjects)
    for subject in subjects:
        assert subject.notes == (
            '1 more face was found in a.jpg; --faces all (in Python faces="all") reads it too.',
        )


def test_a_mask_ends_in_the_middle_between_two_faces(astronaut: np.ndarray) -> None:
    scene = make_scene(astronaut, 160, 160)
    left, right = find_subjects(scene, "a.jpg", "all", "face")
    for subject, mine in ((left, slice(0, 160)), (right, slice(160, 320))):
        box = subject.crop.box
        mask = np.ones((box.height, box.width), np.float32)
        kept = np.zeros(scene.shape[:2], bool)
        kept[box.slices] = subject.keep_own_skin(mask) > 0.5
        assert kept[:, mine].any()
        kept[:, max(0, mine.start - 3) : mine.stop + 3] = False
        assert not kept.any()


def test_a_face_alone_keeps_all_its_skin(astronaut: np.ndarray) -> None:
    (subject,) = find_subjects(astronaut, "a.jpg", None, "face")
    mask = np.ones((20, 20), np.float32)
    np.testing.assert_array_equal(subject.keep_own_skin(mask), mask)
    assert subject.notes == ()


def test_faces_that_cannot_be_read_are_left_out_of_a_group(astronaut: np.ndarray) -> None:
    scene = np.full((300, 300, 3), 100, np.uint8)
    scene[:160, :160] = astronaut[40:200, 144:304]
    scene[200:232, 220:252] = resize(np.ascontiguousarray(astronaut[40:200, 144:304]), 32, 32)
    (subject,) = find_subjects(scene, "a.jpg", "all", "face")
    assert subject.face_id == 1
    several, note = subject.notes
    assert several == "a.jpg shows 2 faces, numbered from left to right."
    assert note.startswith("1 of 2 faces was left out. Face 2 in a.jpg is ")
    assert "pixels wide, and 24 are needed" in note


def test_a_turned_face_has_a_turned_crop(astronaut: np.ndarray) -> None:
    sideways = np.ascontiguousarray(np.rot90(astronaut))
    (subject,) = find_subjects(sideways, "a.jpg", None, "face")
    assert subject.crop.square is not None and subject.face is not None
    assert abs(subject.face.tilt + 90) < 6


def test_bare_skin_has_a_mask_of_its_colours(astronaut: np.ndarray) -> None:
    cheek = np.ascontiguousarray(astronaut[110:150, 235:260])
    (subject,) = find_subjects(cheek, "a.jpg", None, "skin")
    assert subject.face is subject.face_id is subject.faces is None
    assert subject.skin is not None and (subject.skin > 0.5).mean() > 0.9


def test_what_is_not_there_is_said(astronaut: np.ndarray) -> None:
    suit = np.ascontiguousarray(astronaut[200:])
    with pytest.raises(NoFaceError, match=r"No face was found in a\.jpg\. --region skin"):
        find_subjects(suit, "a.jpg", None, "face")
    with pytest.raises(InputError, match=r"No skin was found in a\.jpg"):
        find_subjects(suit, "a.jpg", None, "skin")
