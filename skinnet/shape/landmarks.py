"""Landmarks: named points of a face, as vertices of a model or positions on a scan."""

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float
from scipy.spatial import cKDTree

from skinnet.errors import InputError
from skinnet.files import write_text
from skinnet.mesh.mesh import Mesh
from skinnet.shape._ibug import resolve_name
from skinnet.shape._landmark_formats import parse_landmark_file
from skinnet.shape.model import ShapeModel
from skinnet.shape.similarity import fit_similarity

MIN_COUNT = 4
"""A fit needs at least this many landmarks in common with its model."""

MAX_DISTANCE = 0.1
"""Largest distance of a landmark from the mesh, in lengths of the mesh."""

MIRRORED_RATIO = 0.2
"""Squared residual of the best reflection over that of the best rotation; below this, left and
right are swapped. It is above 5 for real and synthetic faces, below 0.2 for swapped ones, and near
1 for points in a plane."""


def read_landmarks(path: Path, mesh: Mesh | None = None) -> dict[str, Float[np.ndarray, "3"]]:
    """Read the named points of a scan.

    Formats are .csv (lines name,x,y,z), .json (name to [x, y, z], or to the number of a vertex of
    `mesh`), menpo's .ljson (landmarker.io, versions 1 to 3) and MeshLab's .pp. A name may be one of
    `IBUG`, ibug_<number>, or the number among iBUG's 68 from 0; other names are kept.

    Args:
        path: The file.
        mesh: The scan, for a file that gives vertex numbers.

    Returns:
        Points by name, in the unit and frame of the file.

    Raises:
        InputError: If the file is missing or damaged, or a vertex is out of range.

    Example:
        >>> from pathlib import Path
        >>> from skinnet.shape import read_landmarks
        >>> _ = Path("face.csv").write_text("nose_tip,0,1.5,9")
        >>> read_landmarks(Path("face.csv"))
        {'nose_tip': array([0. , 1.5, 9. ])}
    """
    named = {resolve_name(name): value for name, value in parse_landmark_file(Path(path)).items()}
    return {name: _locate(path, name, value, mesh) for name, value in named.items()}


def read_landmark_vertices(path: Path, vertex_count: int) -> dict[str, int]:
    """Read the vertices of a model's landmarks from a .json file of names and vertex numbers.

    Args:
        path: The file. Names are as for `read_landmarks`.
        vertex_count: Number of the model's vertices.

    Returns:
        Vertices by name.

    Raises:
        InputError: If the file is missing or damaged, or a vertex is out of range.

    Example:
        >>> from pathlib import Path
        >>> from skinnet.shape import read_landmark_vertices
        >>> _ = Path("model.json").write_text('{"8": 120, "nose_tip": 7}')
        >>> read_landmark_vertices(Path("model.json"), vertex_count=200)
        {'chin': 120, 'nose_tip': 7}
    """
    named = {resolve_name(name): value for name, value in parse_landmark_file(Path(path)).items()}
    return {name: _check_vertex(path, name, value, vertex_count) for name, value in named.items()}


def write_landmarks(path: Path, points: Mapping[str, Float[np.ndarray, "3"]]) -> None:
    """Write named points as .csv or .json, in the form that `read_landmarks` reads.

    Args:
        path: The file, with the suffix .csv or .json.
        points: Points by name.

    Raises:
        InputError: If `path` has another suffix.

    Example:
        >>> import numpy as np
        >>> from pathlib import Path
        >>> from skinnet.shape import write_landmarks
        >>> write_landmarks(Path("chin.csv"), {"chin": np.array([0, -80, 12.5])})
        >>> Path("chin.csv").read_text().splitlines()
        ['name,x,y,z', 'chin,0,-80,12.5']
    """
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
    points: Mapping[str, Float[np.ndarray, "3"]],
    model: ShapeModel,
    mesh: Mesh | None = None,
    name: str = "The landmarks",
) -> list[str]:
    """Check that the landmarks of a scan can start a fit.

    Args:
        points: Points of the scan by name.
        model: The shape model, whose landmarks have the same names.
        mesh: The scan; None to skip the distance check.
        name: What error messages call the points.

    Returns:
        Names that scan and model have in common, in the model's order.

    Raises:
        InputError: If fewer than four names are common, or points are not finite, lie on a line,
            are far from the mesh, or fit the model's mirror image better than the model.

    Example:
        >>> from skinnet.shape import check_landmarks, load_shape_model
        >>> model = load_shape_model()
        >>> points = {name: model.mean[vertex] for name, vertex in model.landmarks.items()}
        >>> len(check_landmarks(points, model))
        20
    """
    if not model.landmarks:
        raise InputError(
            f"{model.name} has no landmarks; give a .json file of names and vertex numbers."
        )
    common = [each for each in model.landmarks if each in points]
    if len(common) < MIN_COUNT:
        missing = ", ".join(each for each in model.landmarks if each not in points)
        raise InputError(
            f"{name}: {len(common)} of the model's {len(model.landmarks)} are there, and at least "
            f"{MIN_COUNT} are needed; missing are {missing}."
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
    if distance[worst] > MAX_DISTANCE:
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
    if mirrored + 1e-9 * spread[0] ** 2 < MIRRORED_RATIO * residual:
        raise InputError(f"{name} appear mirrored; swap left and right.")


def _locate(path: Path, name: str, value: Any, mesh: Mesh | None) -> Float[np.ndarray, "3"]:
    if isinstance(value, int) and mesh is not None:
        return np.array(
            mesh.vertices[_check_vertex(path, name, value, len(mesh.vertices))], np.float64
        )
    if isinstance(value, int):
        raise InputError(f"{path} gives {name} as the number of a vertex; give the mesh too.")
    if not isinstance(value, Sequence) or len(value) != 3:
        raise InputError(f"{path}: {name} is {value!r}, and three coordinates are needed.")
    try:
        return np.array([float(number) for number in value])
    except (TypeError, ValueError) as error:
        raise InputError(f"{path}: {name} is {value!r}, which are not numbers.") from error


def _check_vertex(path: Path, name: str, value: Any, count: int) -> int:
    if not isinstance(value, int) or not 0 <= value < count:
        raise InputError(
            f"{path}: {name} is vertex {value!r}, and vertices go from 0 to {count - 1:,}."
        )
    return value
