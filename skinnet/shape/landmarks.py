"""Landmarks: named points of a face, as vertices of a model or positions on a scan."""

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float

from skinnet.errors import InputError
from skinnet.files import write_text
from skinnet.mesh.mesh import Mesh
from skinnet.shape._ibug import resolve_name
from skinnet.shape._landmark_formats import parse_landmark_file
from skinnet.shape._landmark_vertices import check_vertex


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


def _locate(path: Path, name: str, value: Any, mesh: Mesh | None) -> Float[np.ndarray, "3"]:
    if isinstance(value, int) and mesh is not None:
        return np.array(
            mesh.vertices[check_vertex(path, name, value, len(mesh.vertices))], np.float64
        )
    if isinstance(value, int):
        raise InputError(f"{path} gives {name:.60} as the number of a vertex; give the mesh too.")
    if not isinstance(value, Sequence) or isinstance(value, str) or len(value) != 3:
        raise InputError(f"{path}: {name:.60} is {value!r:.60}, and three coordinates are needed.")
    try:
        point = np.array([float(number) for number in value])
    except (TypeError, ValueError, OverflowError) as error:
        raise InputError(f"{path}: {name:.60} is {value!r:.60}, which are not numbers.") from error
    if not np.isfinite(point).all():
        raise InputError(f"{path}: {name:.60} is {value!r:.60}, which is no place on a face.")
    return point
