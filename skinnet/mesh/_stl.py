"""STL files, in text and in binary."""

import re
from pathlib import Path

import numpy as np
from jaxtyping import Float

from skinnet.errors import InputError
from skinnet.files._reading import read_file
from skinnet.mesh._face_parts import GREY
from skinnet.mesh._mesh_parts import MeshContent, MeshGeometry, MeshPart, refuse_points
from skinnet.mesh._obj_lines import convert
from skinnet.mesh._texture_file import Texture

_HEAD, _FACET = 84, np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("more", "<u2")])
_WORDS = re.compile(rb"\b(solid|facet|normal|outer|loop|vertex|endloop|endfacet|endsolid)\b", re.I)


def read_stl_content(
    path: Path, given: Texture | None = None, textured: bool = True
) -> MeshContent:
    """Read an STL file, which has no texture coordinates.

    Args:
        path: The file.
        given: Not used.
        textured: Not used.

    Raises:
        InputError: For a file that is damaged, cut short, or has no triangles.
    """
    content = read_file(path)
    stated = int.from_bytes(content[80:_HEAD], "little")
    # Binary files may begin with `solid` too.
    if len(content) == _HEAD + stated * _FACET.itemsize and len(content) > _HEAD:
        corners = _read_binary(content, stated)
    elif b"\0" not in content and re.search(rb"(?i)\bfacet\b", content):
        corners = _read_text(path, content)
    else:
        corners = _read_inexact(path, content, stated)
    if not len(corners):
        raise refuse_points(path, 0)
    geometry = MeshGeometry(corners.reshape(-1, 3), np.arange(3 * len(corners)).reshape(-1, 3))
    return MeshContent([MeshPart(geometry, None, None, GREY)], [], False, np.zeros((0, 3)))


def _read_binary(content: bytes, count: int) -> Float[np.ndarray, "triangles 3 3"]:
    return np.frombuffer(content, _FACET, count, _HEAD)["corners"].astype(np.float64)


def _read_inexact(path: Path, content: bytes, stated: int) -> Float[np.ndarray, "triangles 3 3"]:
    """Read a binary file with a few bytes behind its triangles."""
    held = max(len(content) - _HEAD, 0) // _FACET.itemsize
    if held != stated or len(content) < _HEAD:
        raise InputError(
            f"{path} cannot be read as a mesh: it states {stated:,} triangles and has the length "
            f"of {held:,}; copy or export it again."
        )
    return _read_binary(content, stated)


def _read_text(path: Path, content: bytes) -> Float[np.ndarray, "triangles 3 3"]:
    # What stands behind `solid` and `endsolid` is a name.
    body = re.sub(rb"(?im)^[ \t]*(end)?solid\b[^\n]*", b"", content.replace(b"\r", b"\n"))
    words = [word.lower() for word in _WORDS.findall(body)]
    opened, closed = words.count(b"facet"), words.count(b"endfacet")
    values = convert(_WORDS.sub(b" ", body), np.float64)
    if opened != closed or len(values) != 12 * opened:
        raise InputError(
            f"{path} cannot be read as a mesh: its facets are not all complete, with three "
            "vertices each; copy or export it again."
        )
    return values.reshape(-1, 4, 3)[:, 1:]
