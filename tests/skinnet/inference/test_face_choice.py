import numpy as np
import pytest

from skinnet.errors import InputError
from skinnet.images import Box, Face
from skinnet.inference._face_choice import FaceChoice, check_choice, choose_faces, note_others


def make_faces(*widths: int) -> list[Face]:
    landmarks = np.zeros((478, 2), np.float32)
    return [Face(Box(0, 0, width, width), 0.0, 1.0, landmarks) for width in widths]


@pytest.mark.parametrize(
    ("faces", "chosen"),
    [
        ("all", [0, 1, 2, 3]),
        ("largest", [1]),
        (1, [1]),
        (2, [1, 3]),
        (3, [1, 2, 3]),
        (9, [0, 1, 2, 3]),
    ],
)
def test_the_largest_faces_from_left_to_right(faces: FaceChoice, chosen: list[int]) -> None:
    assert choose_faces(make_faces(20, 50, 30, 40), faces) == chosen


def test_of_equal_faces_the_left_one_is_read() -> None:
    assert choose_faces(make_faces(30, 30), "largest") == [0]
    assert choose_faces([], "all") == []


@pytest.mark.parametrize("faces", ["all", "largest", 1, np.int64(3)])
def test_words_and_numbers_are_known(faces: object) -> None:
    check_choice(faces)


@pytest.mark.parametrize("faces", [0, -1, True, 1.5, "two", "1", None])
def test_others_are_refused_with_their_value(faces: object) -> None:
    with pytest.raises(InputError, match=f"largest, from 1; got {faces!r}"):
        check_choice(faces)


def test_faces_are_counted() -> None:
    assert note_others(1, 1, "a.jpg") == ()
    assert note_others(2, 2, "a.jpg") == ("a.jpg shows 2 faces, numbered from left to right.",)
    assert note_others(2, 1, "a.jpg")[0].startswith("1 more face was found in a.jpg; --faces all")
    assert note_others(4, 2, "a.jpg")[0].startswith("2 more faces were found in a.jpg; --faces all")
