"""Files of landmarks: .csv, .json, menpo's .ljson and MeshLab's .pp."""

import csv
import json
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any
from xml.parsers import expat
from xml.parsers.expat import ExpatError

from skinnet.errors import InputError, _name_error
from skinnet.files import READ_ERRORS
from skinnet.files._reading import MOST_TEXT, read_file

# menpo's left and right are those of the picture: its left eye is the person's right one.
_GROUPS = {
    "chin": range(0, 17),
    "jaw": range(0, 17),
    "leyebrow": range(17, 22),
    "left_eyebrow": range(17, 22),
    "reyebrow": range(22, 27),
    "right_eyebrow": range(22, 27),
    "nose": range(27, 36),
    "leye": range(36, 42),
    "left_eye": range(36, 42),
    "reye": range(42, 48),
    "right_eye": range(42, 48),
    "mouth": range(48, 68),
}


def parse_landmark_file(path: Path) -> Mapping[str, Any]:
    """Parse a .csv, .json, .ljson or .pp file into names and points, or vertex numbers.

    Raises `InputError` for a file that is missing, damaged or of another kind.
    """
    parse = _PARSERS.get(path.suffix.lower())
    if parse is None:
        raise InputError(f"{path} is not a landmark file; give one of {', '.join(_PARSERS)}.")
    try:
        content = read_file(path, MOST_TEXT)
    except FileNotFoundError:
        raise InputError(f"There is no landmark file {path}; check the path.") from None
    except OSError as error:
        raise InputError(f"{path} cannot be read ({error.strerror}); check the path.") from error
    try:
        return parse(content)
    except InputError as error:
        raise InputError(f"{path} cannot be used: {error}.") from error
    except (*READ_ERRORS, ExpatError) as error:
        raise InputError(
            f"{path} is damaged or of another layout ({_name_error(error)})."
        ) from error


def _parse_ljson(document: Mapping[str, Any]) -> dict[str, list[float]]:
    """Parse a landmarker.io file, versions 1 to 3, into iBUG numbers and points.

    Of several sets of points, the first counts. Points are numbered by their label and place in it;
    68 points under unknown labels are numbered in their order. Points that are null are left out.
    Raises `InputError` or `KeyError`, `TypeError`, `ValueError` or `IndexError` for another layout.
    """
    version = document["version"]
    if version == 1:
        labelled = [
            (group["label"], [mark["point"] for mark in group["landmarks"]])
            for group in document["groups"]
        ]
    else:
        sets = [document] if version == 2 else list(document["groups"].values())
        points = sets[0]["landmarks"]["points"]
        labelled = [
            (label["label"], [points[i] for i in label["mask"]]) for label in sets[0]["labels"]
        ]
    return _number_points(labelled)


def _parse_pp(text: bytes) -> dict[str, list[float]]:
    """Parse a MeshLab file of picked points into names and points; inactive ones are left out.

    Raises `InputError` for entities, and `ExpatError`, `KeyError` or `ValueError` for another file.
    """
    found: dict[str, list[float]] = {}

    def start(tag: str, values: dict[str, str]) -> None:
        if tag == "point" and values.get("active", "1") != "0":
            found[values["name"]] = [float(values[axis]) for axis in "xyz"]

    def refuse(*_: object) -> None:
        raise InputError("the file declares XML entities, which a list of points does not need")

    parser = expat.ParserCreate()
    parser.StartElementHandler = start
    parser.EntityDeclHandler = refuse
    parser.Parse(text, True)
    return found


def _number_points(labelled: list[tuple[str, list[Any]]]) -> dict[str, list[float]]:
    known = [(label, points) for label, points in labelled if label in _GROUPS]
    everything = [point for _, points in labelled for point in points]
    if known:
        for label, points in known:
            if len(points) != len(_GROUPS[label]):
                raise InputError(
                    f"label {label} has {len(points)} points instead of {len(_GROUPS[label])}"
                )
        pairs = [
            pair for label, points in known for pair in zip(_GROUPS[label], points, strict=True)
        ]
    elif len(everything) == 68:
        pairs = list(enumerate(everything))
    else:
        names = ", ".join(str(label) for label, _ in labelled)
        raise InputError(f"its labels ({names:.100}) are not those of a face")
    return {
        str(number): [float(value) for value in point if value is not None]
        for number, point in pairs
        if None not in point
    }


def _parse_csv(text: bytes) -> dict[str, list[float]]:
    rows = [row for row in csv.reader(text.decode("utf-8-sig").splitlines()) if row]
    if rows and [cell.strip().lower() for cell in rows[0]] == ["name", "x", "y", "z"]:
        rows = rows[1:]
    named = {}
    for row in rows:
        if len(row) != 4:
            raise InputError(f"the line {','.join(row)!r:.60} is not name,x,y,z")
        named[row[0]] = [float(value) for value in row[1:]]
    return named


def _parse_json(text: bytes) -> Mapping[str, Any]:
    document = json.loads(text)
    if not isinstance(document, dict):
        raise InputError("it is not an object of names")
    return document


_PARSERS: Mapping[str, Callable[[bytes], Mapping[str, Any]]] = {
    ".csv": _parse_csv,
    ".json": _parse_json,
    ".ljson": lambda text: _parse_ljson(json.loads(text)),
    ".pp": _parse_pp,
}
