"""The benchmark of finding faces, on a handful of pictures."""

import csv
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from skimage.data import astronaut

from benchmarks import faceless, faces
from benchmarks.cascade import find_face
from benchmarks.face_count import FaceCount, add_up, measure_overlap
from benchmarks.face_landmarks import find_inside, measure_distance, measure_distances
from benchmarks.face_pictures import FacePicture, hide_half, shrink, turn
from benchmarks.portrait_faces import list_portraits, read_template
from skinnet.errors import InputError
from skinnet.images import Box, find_faces

FACE = Box(170, 62, 277, 169)


@pytest.fixture(name="astronaut")
def load_astronaut() -> np.ndarray:
    return astronaut()


@pytest.fixture
def folder(astronaut: np.ndarray, tmp_path: Path) -> Path:
    """One portrait of each set; the template is made of the landmarks that are found."""
    for name in ("congress", "london"):
        (tmp_path / name).mkdir()
        Image.fromarray(astronaut).save(tmp_path / name / "one.jpg", quality=95)
    with (tmp_path / "congress" / "index.csv").open("w", newline="") as file:
        rows = csv.writer(file)
        rows.writerow(["file", "width", "height", "face_x", "face_y", "face_w", "face_h"])
        rows.writerow(["one.jpg", 512, 512, *FACE[:2], FACE.width, FACE.height])
    write_template(tmp_path / "london" / "one.tem", find_faces(astronaut)[0].landmarks)
    return tmp_path


def write_template(path: Path, landmarks: np.ndarray) -> None:
    points = np.zeros((189, 2))
    for same, on_mesh in (
        ((0, 1, 129, 18, 22, 23, 27), (468, 473, 152, 33, 133, 362, 263)),
        ((19, 20, 21, 30, 29, 28), (160, 159, 158, 153, 145, 144)),
        ((24, 25, 26, 33, 32, 31), (385, 386, 387, 373, 374, 380)),
    ):
        points[list(same)] = landmarks[list(on_mesh)] - 0.5
    lines = [f"{x}\t{y}" for x, y in points.tolist()]
    path.write_text("\n".join(["189", *lines, "1", "0", "2", "0 0"]), encoding="utf-8")


@pytest.mark.slow
def test_figures_of_two_portraits(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(faces, "GROUPS", 1)
    monkeypatch.setattr(faceless, "PHOTOGRAPHS", ("brick", "page"))
    found = faces.measure(folder)
    assert all(found[f"tilt_{tilt}"] == 1 for tilt in faces.TILTS)
    assert found["small"] == found["group"] == found["half_hidden"] == 1
    assert found["twice"] == found["false"] == 0
    assert found["landmarks"]["eyes"] < 0.01
    assert found["sclera"] is None, "The eyes are too small."
    assert set(faces.ASKED) < set(found)
    assert "tilt_45" in faces.layout(found)


def test_portraits_are_listed_with_their_boxes(folder: Path) -> None:
    congress, london = list_portraits(folder)
    assert congress.box == FACE and measure_overlap(london.box, FACE) > 0.8
    assert len(read_template(london.path.with_suffix(".tem"))) == 189
    with pytest.raises(InputError, match="give the portraits with --faces"):
        list_portraits(folder / "london")


def test_the_cascade_finds_what_it_found(astronaut: np.ndarray) -> None:
    assert find_face(astronaut) == FACE


def test_claims_are_counted() -> None:
    picture = FacePicture(
        np.zeros((200, 400, 3), np.uint8), [Box(50, 50, 100, 100), Box(250, 50, 300, 100)]
    )
    count = FaceCount()
    count.add(picture, [Box(52, 50, 102, 100), Box(45, 60, 90, 105), Box(350, 150, 380, 180)])
    assert count == FaceCount(faces=2, found=1, twice=1, false=1, pictures=1)
    assert add_up([count, count]).share == 0.5


def test_boxes_move_with_the_picture(astronaut: np.ndarray) -> None:
    for picture in (
        turn(astronaut, FACE, 30),
        turn(astronaut, FACE, -45),
        shrink(astronaut, FACE, 0.5),
    ):
        (face,) = find_faces(picture.photo)
        assert measure_overlap(face.box, picture.boxes[0]) > 0.75


def test_half_of_a_face_is_hidden(astronaut: np.ndarray) -> None:
    for number in range(16):
        hidden = (hide_half(astronaut, FACE, number).photo != astronaut).any(-1)[FACE.slices]
        assert 0.4 < hidden.mean() < 0.6


def test_distances_are_from_lines() -> None:
    line = np.array([[0.0, 0], [10, 0], [10, 10]])
    assert measure_distance(np.array([5.0, 3]), line) == 3
    assert measure_distance(np.array([13.0, 14]), line) == 5
    assert measure_distance(np.array([3.0, 4]), line[:1]) == 5


def test_a_template_is_at_its_own_landmarks(folder: Path, astronaut: np.ndarray) -> None:
    template = read_template(folder / "london" / "one.tem")
    landmarks = find_faces(astronaut)[0].landmarks
    assert max(measure_distances(template, landmarks)["eyes"]) < 1e-4
    inside = find_inside(template, np.concatenate([landmarks[[468, 473]], [[0, 0]]]))
    assert inside.tolist() == [True, True, False]
