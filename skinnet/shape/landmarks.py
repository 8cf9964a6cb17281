"""Named points of a face: on a model as vertices, on a scan as positions."""

import csv
import json
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any
from xml.parsers.expat import ExpatError

import numpy as np
from jaxtyping import Float
from scipy.spatial import cKDTree

from skinnet.errors import InputError
from skinnet.files import write_text
from skinnet.mesh.mesh import Mesh
from skinnet.shape._landmark_formats import parse_ljson, parse_pp
from skinnet.shape.model import ShapeModel
from skinnet.shape.similarity import fit_similarity

IBUG = {
    "right_brow_outer": 17,
    "right_brow_inner": 21,
    "left_brow_inner": 22,
    "left_brow_outer": 26,
    "nose_bridge": 27,
    "nose_tip": 30,
    "right_nostril": 31,
    "nose_base": 33,
    "left_nostril": 35,
    "right_eye_outer": 36,
    "right_eye_inner": 39,
    "left_eye_inner": 42,
    "left_eye_outer": 45,
    "mouth_right": 48,
    "mouth_top": 51,
    "mouth_left": 54,
    "mouth_bottom": 57,
    "lips_upper": 62,
    "lips_lower": 66,
    "chin": 8,
}
"""The landmarks of a fit with their numbers among iBUG's 68; right is the person's right, x < 0."""

POINTS = 68
FEWEST = 4
"""A fit needs at least this many landmarks in common with its model."""

FAR = 0.1
"""Largest distance of a landmark from the mesh, in lengths of the mesh."""

MIRRORED = 0.2
"""Squares left by the best reflection over those of the best rotation: below, sides are swapped.
Of real and drawn faces it is above 5, of swapped ones below 0.2, of points in a plane near 1."""

Point = Float[np.ndarray, "3"]
_NAMES = {number: name for name, number in IBUG.items()}


def name_ibug_point(number: int) -> str:
    """The name of a point of iBUG's 68: one of `IBUG`, else ibug_<number>."""
    return _NAMES.get(number, f"ibug_{number}")


def read_landmarks(path: Path, mesh: Mesh | None = None) -> dict[str, Point]:
    """Named points of a scan, in its unit and frame.

    From .csv (lines name,x,y,z), .json (name to [x, y, z], or to the number of a vertex of `mesh`),
    menpo's .ljson (landmarker.io, versions 1 to 3) or MeshLab's .pp. A name may be one of `IBUG`,
    ibug_<number>, or the number among iBUG's 68 from 0; others are kept.

    Raises `InputError` for a file that is missing or damaged, and for a vertex out of range.
    """
    named = {_canonical(name): value for name, value in _parse(Path(path)).items()}
    return {name: _position(path, name, value, mesh) for name, value in named.items()}


def read_landmark_vertices(path: Path, vertex_count: int) -> dict[str, int]:
    """Vertices of a model's landmarks from .json (name to vertex); names as in `read_landmarks`."""
    named = {_canonical(name): value for name, value in _parse(Path(path)).items()}
    return {name: _vertex(path, name, value, vertex_count) for name, value in named.items()}


def write_landmarks(path: Path, points: Mapping[str, Point]) -> None:
    """Write named points as .csv or .json, for `read_landmarks`."""
    rows = {name: [float(value) for value in point] for name, point in points.items()}
    suffix = Path(path).suffix.lower()
    if suffix == ".json":
        write_text(Path(path), json.dumps(rows, indent=2) + "\n")
    elif suffix == ".csv":
        lines = [f"{name},{x:.9g},{y:.9g},{z:.9g}\n" for name, (x, y, z) in rows.items()]
        write_text(Path(path), "".join(["name,x,y,z\n", *lines]))
    else:
        raise InputError(f"Landmarks are written as .csv or .json; got {path}.")


def check_landmarks(
    points: Mapping[str, Point],
    model: ShapeModel,
    mesh: Mesh | None = None,
    name: str = "The landmarks",
) -> list[str]:
    """Names that the points of a scan and a model have in common, in the model's order.

    `mesh` is the scan; `name` stands for the points in errors. Raises `InputError` if fewer than
    `FEWEST` are common, or some are not finite, lie on a line, far from the mesh, or fit the
    model's mirror image better than the model.
    """
    if not model.landmarks:
        raise InputError(
            f"{model.name} has no landmarks; give a .json file of names and vertex numbers."
        )
    common = [each for each in model.landmarks if each in points]
    if len(common) < FEWEST:
        missing = ", ".join(each for each in model.landmarks if each not in points)
        raise InputError(
            f"{name}: {len(common)} of the model's {len(model.landmarks)} are there, and at least "
            f"{FEWEST} are needed; missing are {missing}."
        )
    target = np.stack([points[each] for each in common]).astype(np.float64)
    bad = [each for each, point in zip(common, target, strict=True) if not np.isfinite(point).all()]
    if bad:
        raise InputError(f"{name}: {', '.join(bad)} are not finite numbers; mark them again.")
    if mesh is not None:
        _check_near(common, target, mesh, name)
    source = model.mean[[model.landmarks[each] for each in common]].astype(np.float64)
    _check_side(source, target, name)
    return common


def _check_near(
    names: list[str], points: Float[np.ndarray, "points 3"], mesh: Mesh, name: str
) -> None:
    length = float(np.ptp(mesh.vertices, axis=0).max())
    distance = np.asarray(cKDTree(mesh.vertices).query(points)[0]) / length
    worst = int(distance.argmax())
    if distance[worst] > FAR:
        raise InputError(
            f"{name}: {names[worst]} is {distance[worst]:.2g} times the length of {mesh.name} away "
            "from it; are they in the same unit and frame?"
        )


def _check_side(
    source: Float[np.ndarray, "points 3"], target: Float[np.ndarray, "points 3"], name: str
) -> None:
    spread = np.linalg.svd(target - target.mean(0), compute_uv=False)
    if spread[1] <= 1e-3 * spread[0]:
        raise InputError(f"{name} lie on a line, or all in one place; mark them on the face.")
    residual, mirrored = (
        float(np.square(fit_similarity(source, target, reflection)(source) - target).sum())
        for reflection in (False, True)
    )
    if mirrored + 1e-9 * spread[0] ** 2 < MIRRORED * residual:
        raise InputError(f"{name} appear mirrored; swap left and right.")


def _parse(path: Path) -> Mapping[str, Any]:
    parse = _PARSERS.get(path.suffix.lower())
    if parse is None:
        raise InputError(f"{path} is no landmark file; give one of {', '.join(_PARSERS)}.")
    try:
        return parse(path.read_bytes())
    except FileNotFoundError:
        raise InputError(f"There is no landmark file {path}; check the path.") from None
    except InputError as error:
        raise InputError(f"{path} cannot be used: {error}.") from error
    except (OSError, ExpatError, ValueError, LookupError, TypeError, AttributeError) as error:
        raise InputError(f"{path} is damaged or of another layout ({error!r}).") from error


def _csv(text: bytes) -> dict[str, list[float]]:
    rows = [row for row in csv.reader(text.decode("utf-8-sig").splitlines()) if row]
    if rows and [cell.strip().lower() for cell in rows[0]] == ["name", "x", "y", "z"]:
        rows = rows[1:]
    named = {}
    for row in rows:
        if len(row) != 4:
            raise InputError(f"the line {','.join(row)!r} is not name,x,y,z")
        named[row[0]] = [float(value) for value in row[1:]]
    return named


def _json(text: bytes) -> Mapping[str, Any]:
    document = json.loads(text)
    if not isinstance(document, dict):
        raise InputError("it is no object of names")
    return document


_PARSERS: Mapping[str, Callable[[bytes], Mapping[str, Any]]] = {
    ".csv": _csv,
    ".json": _json,
    ".ljson": lambda text: parse_ljson(json.loads(text)),
    ".pp": parse_pp,
}


def _canonical(name: str) -> str:
    number = name.strip().removeprefix("ibug_")
    if not number.isdecimal():
        return name.strip()
    if int(number) >= POINTS:
        raise InputError(f"Landmark {name} is none of iBUG's, which go from 0 to {POINTS - 1}.")
    return name_ibug_point(int(number))


def _position(path: Path, name: str, value: Any, mesh: Mesh | None) -> Point:
    if isinstance(value, int) and mesh is not None:
        return np.array(mesh.vertices[_vertex(path, name, value, len(mesh.vertices))], np.float64)
    if isinstance(value, int):
        raise InputError(f"{path} gives {name} as the number of a vertex; hand in the mesh too.")
    if not isinstance(value, Sequence) or len(value) != 3:
        raise InputError(f"{path}: {name} is {value!r}, and three coordinates are wanted.")
    try:
        return np.array([float(number) for number in value])
    except (TypeError, ValueError) as error:
        raise InputError(f"{path}: {name} is {value!r}, which are no numbers.") from error


def _vertex(path: Path, name: str, value: Any, count: int) -> int:
    if not isinstance(value, int) or not 0 <= value < count:
        raise InputError(
            f"{path}: {name} is vertex {value!r}, and vertices go from 0 to {count - 1:,}."
        )
    return value
