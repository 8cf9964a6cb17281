"""The measured cameras by name, as users and EXIF write it."""

import csv
import difflib
import re
from functools import cache
from importlib.resources import files
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

_WORDS_WITHOUT_MEANING = frozenset("camera co company corp corporation digital imaging ltd".split())
_COMPONENTS = 6


class Camera(NamedTuple):
    """A camera whose sensitivities are measured.

    Attributes:
        name: Its name in the table.
        coefficients: Coefficients of the camera basis, in standard deviations.
        matrix: From sensor values [3] balanced under D65 to linear sRGB, [3, 3]; rows sum to 1.
    """

    name: str
    coefficients: tuple[float, ...]
    matrix: NDArray[np.float64]


def find_camera(name: str) -> Camera | None:
    """Find a measured camera by a name that its maker, EXIF or users give it; None if unknown."""
    return _index_names().get(_fold(name))


def list_close_names(name: str, count: int = 3) -> list[str]:
    """List the names of the measured cameras that are most like a name, at least one."""
    keys = _index_names()
    close = difflib.get_close_matches(_fold(name), keys, 4 * count, 0)
    return list(dict.fromkeys(keys[key].name for key in close))[:count]


@cache
def read_cameras() -> tuple[Camera, ...]:
    """Read the table of measured cameras."""
    return tuple(camera for camera, _ in _read_table())


@cache
def _index_names() -> dict[str, Camera]:
    """Cameras by their folded names."""
    index: dict[str, Camera] = {}
    for camera, names in _read_table():
        index |= {_fold(name): camera for name in (camera.name, *names)}
    return index


def _read_table() -> list[tuple[Camera, list[str]]]:
    text = (files(__package__) / "cameras.csv").read_text(encoding="utf-8")
    _, *rows = csv.reader(line for line in text.splitlines() if not line.startswith("#"))
    found = []
    for name, others, *numbers in rows:
        values = [float(number) for number in numbers]
        matrix = np.array(values[_COMPONENTS:]).reshape(3, 3)
        camera = Camera(name, tuple(values[:_COMPONENTS]), matrix)
        found.append((camera, [other for other in others.split(";") if other]))
    return found


def _fold(name: str) -> str:
    """Letters and digits, without what EXIF adds: NIKON CORPORATION NIKON D700 is Nikon D700."""
    words = dict.fromkeys(re.findall(r"[a-z0-9]+", name.lower()))
    return "".join(word for word in words if word not in _WORDS_WITHOUT_MEANING)
