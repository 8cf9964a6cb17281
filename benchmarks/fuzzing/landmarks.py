"""Files of landmarks: CSV, JSON, landmarker.io and MeshLab."""

import json
from pathlib import Path
from random import Random

import numpy as np

from benchmarks.fuzzing.case import Case
from benchmarks.fuzzing.changes import change_text, change_value
from benchmarks.fuzzing.small_shapes import make_dome
from skinnet.shape import read_landmarks
from skinnet.shape._landmark_vertices import read_landmark_vertices

_NAMES = ("nose_tip", "chin", "left_eye_outer", "right_eye_outer", "ibug_36", "45", "é", "")
_POINTS = {name: [float(at), 2.5, -1e-3] for at, name in enumerate(_NAMES)}
_LJSON = {
    "version": 3,
    "groups": {
        "LJSON": {
            "labels": [{"label": "all", "mask": list(range(68))}],
            "landmarks": {"points": [[float(i), i / 2, 3.0] for i in range(68)]},
        }
    },
}
_OLD_LJSON = {
    "version": 1,
    "groups": [{"label": "chin", "landmarks": [{"point": [i, i, 1.5]} for i in range(17)]}],
}
_WORDS = b"name x y z point active nose_tip &a; <!ENTITY null NaN Infinity version mask".split()


def make(rng: Random) -> Case:
    """Make a file of landmarks, which is read with a mesh, without one, or for a model."""
    suffix = rng.choice((".csv", ".json", ".ljson", ".pp", "vertices"))
    if suffix == "vertices":
        vertices = {name: at for at, name in enumerate(_NAMES)}
        return Case(_read_vertices, {"points.json": _write_json(vertices, rng)})
    mesh = rng.choice((None, make_dome()))
    name = f"points{suffix}"
    return Case(lambda folder: _read(folder / name, mesh), {name: _write(suffix, rng)}, name)


def _read(path: Path, mesh: object) -> None:
    points = read_landmarks(path, mesh)  # type: ignore[arg-type]
    for name, point in points.items():
        assert isinstance(name, str) and point.shape == (3,) and np.isfinite(point).all(), name


def _read_vertices(folder: Path) -> None:
    found = read_landmark_vertices(folder / "points.json", len(make_dome().vertices))
    assert all(0 <= each < len(make_dome().vertices) for each in found.values())


def _write(suffix: str, rng: Random) -> bytes:
    if suffix == ".csv":
        lines = ["name,x,y,z", *(f"{name},{x},{y},{z}" for name, (x, y, z) in _POINTS.items())]
        return change_text("\n".join(lines).encode(), rng, tuple(_WORDS))
    if suffix == ".pp":
        points = "".join(
            f'<point x="{x}" y="{y}" z="{z}" name="{name}" active="1"/>\n'
            for name, (x, y, z) in _POINTS.items()
        )
        text = f"<!DOCTYPE PickedPoints>\n<PickedPoints>\n{points}</PickedPoints>\n"
        return change_text(text.encode(), rng, tuple(_WORDS))
    if suffix == ".ljson":
        version = rng.choice((1, 2, 3))
        document = {1: _OLD_LJSON, 2: _LJSON["groups"]["LJSON"] | {"version": 2}, 3: _LJSON}  # type: ignore[index, operator]
        return _write_json(document[version], rng)
    return _write_json(rng.choice((_POINTS, {name: 5 for name in _NAMES})), rng)


def _write_json(document: object, rng: Random) -> bytes:
    for _ in range(rng.choice((0, 1, 1, 2, 4))):
        document = change_value(document, rng)
    text = json.dumps(document).encode()
    return change_text(text, rng, tuple(_WORDS)) if rng.random() < 0.3 else text
