"""Landmarks as vertices of a mesh or model."""

from pathlib import Path
from typing import Any

from skinnet.errors import InputError
from skinnet.shape._ibug import resolve_name
from skinnet.shape._landmark_formats import parse_landmark_file


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
        >>> from skinnet.shape._landmark_vertices import read_landmark_vertices
        >>> _ = Path("model.json").write_text('{"8": 120, "nose_tip": 7}')
        >>> read_landmark_vertices(Path("model.json"), vertex_count=200)
        {'chin': 120, 'nose_tip': 7}
    """
    named = {resolve_name(name): value for name, value in parse_landmark_file(Path(path)).items()}
    return {name: check_vertex(path, name, value, vertex_count) for name, value in named.items()}


def check_vertex(path: Path, name: str, value: Any, count: int) -> int:
    """Refuse a number that is no vertex among `count`."""
    if not isinstance(value, int) or isinstance(value, bool) or not 0 <= value < count:
        raise InputError(
            f"{path}: {name:.60} is vertex {value!r:.60}, and vertices go from 0 to {count - 1:,}."
        )
    return value
