"""Landmarks are read from every format, and what cannot be fitted is refused in words."""

import json
from pathlib import Path

import numpy as np
import pytest
from small_meshes import LANDMARKS, dome

from skinnet.errors import InputError
from skinnet.mesh.mesh import Mesh
from skinnet.mesh.mesh_file import read_mesh
from skinnet.shape._ibug import IBUG, name_ibug_point
from skinnet.shape._landmark_vertices import read_landmark_vertices
from skinnet.shape.landmarks import read_landmarks, write_landmarks

PP = """<!DOCTYPE PickedPoints>
<PickedPoints>
 <DocumentData><DateTime time="12:00:00" date="2020-01-01"/></DocumentData>
 <point active="1" name="nose_tip" x="1" y="2" z="3.5"/>
 <point active="0" name="chin" x="0" y="0" z="0"/>
 <point name="36" x="-1" y="0" z="0"/>
</PickedPoints>
"""
BOMB = '<!DOCTYPE x [<!ENTITY a "aaaa"><!ENTITY b "&a;&a;">]><x><point name="&b;"/></x>'


def points() -> dict[str, np.ndarray]:
    return {name: dome().vertices[vertex] for name, vertex in LANDMARKS.items()}


def group(points: list, labels: dict[str, list[int]]) -> dict:
    return {
        "labels": [{"label": label, "mask": mask} for label, mask in labels.items()],
        "landmarks": {"points": points},
    }


def write_file(path: Path, content: object) -> Path:
    path.write_text(content if isinstance(content, str) else json.dumps(content), encoding="utf-8")
    return path


def test_names_are_those_of_ibug() -> None:
    assert len(IBUG) == 20
    assert name_ibug_point(36) == "right_eye_outer" and name_ibug_point(0) == "ibug_0"
    assert len({name_ibug_point(number) for number in range(68)}) == 68


@pytest.mark.parametrize("suffix", [".csv", ".json"])
def test_landmarks_come_back_as_they_were_written(tmp_path: Path, suffix: str) -> None:
    write_landmarks(tmp_path / f"face{suffix}", points())
    read = read_landmarks(tmp_path / f"face{suffix}")
    assert list(read) == list(LANDMARKS)
    assert all(np.allclose(read[name], point, rtol=1e-8) for name, point in points().items())
    with pytest.raises(InputError, match=r"written as \.csv or \.json"):
        write_landmarks(tmp_path / "face.txt", points())


def test_names_may_be_numbers(tmp_path: Path) -> None:
    path = write_file(tmp_path / "face.csv", "36,1,2,3\nibug_8, 0,0,0\nibug_1,0,0,1\nscar,1,1,1\n")
    assert list(read_landmarks(path)) == ["right_eye_outer", "chin", "ibug_1", "scar"]
    with pytest.raises(InputError, match=r"Landmark 68 is none of iBUG's"):
        read_landmarks(write_file(tmp_path / "far.csv", "68,1,2,3\n"))


def test_vertices_of_a_mesh_stand_for_points(tmp_path: Path) -> None:
    path = write_file(tmp_path / "face.json", {"nose_tip": 31, "chin": [1, 2, 3]})
    read = read_landmarks(path, dome())
    assert np.array_equal(read["nose_tip"], dome().vertices[31])
    assert read["chin"].tolist() == [1, 2, 3]
    with pytest.raises(InputError, match="give the mesh"):
        read_landmarks(path)


@pytest.mark.parametrize("vertex", [63, -1])
def test_vertices_out_of_range_are_refused(tmp_path: Path, vertex: int) -> None:
    path = write_file(tmp_path / "face.json", {"nose_tip": vertex})
    message = rf"face\.json: nose_tip is vertex {vertex}, and vertices go from 0 to 62"
    with pytest.raises(InputError, match=message):
        read_landmarks(path, dome())
    with pytest.raises(InputError, match=message):
        read_landmark_vertices(path, 63)


def test_picked_points_of_meshlab_are_read(tmp_path: Path) -> None:
    read = read_landmarks(write_file(tmp_path / "face.pp", PP))
    assert list(read) == ["nose_tip", "right_eye_outer"]
    assert read["nose_tip"].tolist() == [1, 2, 3.5]


def test_entities_are_refused(tmp_path: Path) -> None:
    with pytest.raises(
        InputError, match=r"bomb\.pp cannot be used: the file declares XML entities"
    ):
        read_landmarks(write_file(tmp_path / "bomb.pp", BOMB))


def test_every_version_of_ljson_is_read(tmp_path: Path) -> None:
    eye = [[float(i), 0, 1] for i in range(5)] + [[None, None, None]]
    first = {
        "version": 1,
        "groups": [{"label": "leye", "landmarks": [{"point": point} for point in eye]}],
    }
    second = group(eye, {"leye": [0, 1, 2, 3, 4, 5]}) | {"version": 2}
    third = {"version": 3, "groups": {"LJSON": group(eye, {"left_eye": [0, 1, 2, 3, 4, 5]})}}
    for document in (first, second, third):
        read = read_landmarks(write_file(tmp_path / "face.ljson", document))
        assert list(read) == ["right_eye_outer", "ibug_37", "ibug_38", "right_eye_inner", "ibug_40"]
        assert read["right_eye_inner"].tolist() == [3, 0, 1]


def test_sixty_eight_points_under_other_labels_go_by_their_order(tmp_path: Path) -> None:
    all_of_them = [[float(i), 0, 0] for i in range(68)]
    document = group(all_of_them, {"all": list(range(68))}) | {"version": 2}
    read = read_landmarks(write_file(tmp_path / "face.ljson", document))
    assert read["chin"][0] == 8 and read["lips_lower"][0] == 66


@pytest.mark.parametrize(
    ("name", "content", "fault"),
    [
        ("a.csv", "nose_tip,1,2\n", "a.csv cannot be used: the line 'nose_tip,1,2'"),
        ("a.csv", "nose_tip,1,2,x\n", "a.csv is damaged"),
        ("a.json", "[1, 2]", "a.json cannot be used: it is not an object"),
        ("a.json", "{", "a.json is damaged"),
        ("a.json", {"chin": [1, 2]}, "chin is .*and three coordinates are needed"),
        ("a.json", {"chin": "here"}, "chin is 'here'"),
        ("a.json", {"chin": [1, 2, "x"]}, "which are not numbers"),
        ("a.ljson", {"version": 3, "groups": {}}, "a.ljson is damaged"),
        ("a.ljson", group([[0, 0, 0]], {"leye": [0]}) | {"version": 2}, "leye has 1 points"),
        ("a.ljson", group([[0, 0, 0]], {"car": [0]}) | {"version": 2}, "not those of a face"),
        ("a.pp", "<PickedPoints>", "a.pp is damaged"),
        ("a.pts", "", "a.pts is not a landmark file"),
    ],
)
def test_damaged_files_are_refused(tmp_path: Path, name: str, content: object, fault: str) -> None:
    with pytest.raises(InputError, match=fault):
        read_landmarks(write_file(tmp_path / name, content))


def test_a_missing_file_is_named(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"There is no landmark file .*none\.csv"):
        read_landmarks(tmp_path / "none.csv")


@pytest.fixture(scope="module")
def james(shared_data: Path) -> Mesh:
    return read_mesh(shared_data / "scans/james/james.obj")


def test_the_landmarks_of_a_real_scan_lie_on_it(shared_data: Path, james: Mesh) -> None:
    marks = read_landmarks(shared_data / "scans/james/james.ljson")
    assert len(marks) == 68 and set(IBUG) <= marks.keys()
    distances = [np.linalg.norm(james.vertices - point, axis=1).min() for point in marks.values()]
    assert max(distances) < 5


def test_left_is_left_and_up_is_up_on_a_real_scan(shared_data: Path) -> None:
    marks = read_landmarks(shared_data / "scans/james/james.ljson")
    x, y, z = ({name: marks[name][axis] for name in IBUG} for axis in range(3))
    for name in ("eye_outer", "eye_inner", "brow_outer", "brow_inner", "nostril"):
        assert x[f"right_{name}"] < x["nose_tip"] < x[f"left_{name}"]
    assert x["right_eye_outer"] < x["right_eye_inner"] < x["left_eye_inner"] < x["left_eye_outer"]
    assert x["right_brow_outer"] < x["right_brow_inner"] < x["left_brow_inner"]
    assert x["mouth_right"] < x["lips_upper"] < x["mouth_left"]
    down = ["nose_bridge", "nose_tip", "nose_base", "mouth_top", "lips_upper", "mouth_bottom"]
    assert [y[name] for name in down] == sorted((y[name] for name in down), reverse=True)
    assert y["chin"] < y["mouth_bottom"] and max(z, key=z.get) == "nose_tip"


@pytest.mark.parametrize(
    "place", ["123", [1, 2, float("nan")], [1, 2, 1e999], [10**400, 0, 0], True]
)
def test_a_place_is_three_finite_numbers(tmp_path: Path, place: object) -> None:
    path = write_file(tmp_path / "a.json", {"nose_tip": place})
    with pytest.raises(InputError, match=r"nose_tip is .*(coordinates|numbers|no place|vertex)"):
        read_landmarks(path, dome())


def test_what_a_file_holds_is_not_repeated_at_length(tmp_path: Path) -> None:
    (tmp_path / "a.csv").write_bytes(b"chin,1,2,3\n" * 500 + b"\xff")
    write_file(tmp_path / "b.json", {"x" * 5000: "y" * 5000})
    for name in ("a.csv", "b.json"):
        with pytest.raises(InputError) as caught:
            read_landmarks(tmp_path / name)
        assert len(str(caught.value)) < 500
