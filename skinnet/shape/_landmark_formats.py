"""Landmark files of other programs: menpo's .ljson and MeshLab's .pp."""

from collections.abc import Mapping
from typing import Any
from xml.parsers import expat

from skinnet.errors import InputError

# menpo labels sides as the viewer sees them: its left eye is the person's right one.
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


def parse_ljson(document: Mapping[str, Any]) -> dict[str, list[float]]:
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


def parse_pp(text: bytes) -> dict[str, list[float]]:
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
        names = ", ".join(label for label, _ in labelled)
        raise InputError(f"its labels ({names}) are not those of a face")
    return {
        str(number): [float(value) for value in point if value is not None]
        for number, point in pairs
        if None not in point
    }
