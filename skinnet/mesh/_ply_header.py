"""Headers of PLY files: what they state, and a form of them that every reader understands."""

import re
from pathlib import Path
from typing import NamedTuple

from skinnet.errors import InputError

_END = re.compile(rb"(?m)^[ \t]*end_header[ \t]*(\r\n|\n|\r)")
_TEXTURE = re.compile(rb"(?i)(?:comment|obj_info)\s+texturefile:?\s+(.*)")
_INDICES = ("vertex_indices", "vertex_index")


class PlyHeader(NamedTuple):
    """The header of a PLY file.

    Attributes:
        textures: Names of pictures, in order.
        properties: Names of the properties of each element.
        content: The file with its header cleaned of comments, and lines that end with LF.
    """

    textures: list[bytes]
    properties: dict[str, list[str]]
    content: bytes


def read_ply_header(path: Path) -> PlyHeader:
    """Read the header of a PLY file.

    Raises:
        InputError: If it is damaged, or its faces are given in a way that is not read.
    """
    content = path.read_bytes()
    end = _END.search(content)
    if not re.match(rb"\s*ply\s", content, re.IGNORECASE) or end is None:
        raise _refuse(path, "its header does not begin with ply or does not end; export it again")
    head, body = content[: end.start()], content[end.end() :]
    lines = [line.strip() for line in re.split(rb"[\r\n]+", head) if line.strip()]
    textures = [found[1].strip() for line in lines if (found := _TEXTURE.match(line))]
    stated = [line for line in lines if not re.match(rb"(?i)(comment|obj_info)\b", line)]
    if any(line.lower().startswith(b"format ascii") for line in stated):
        body = body.replace(b"\r\n", b"\n").replace(b"\r", b"\n")
    properties = _read_properties(path, stated)
    clean = b"\n".join([*stated, b"end_header", b""])
    return PlyHeader(list(filter(None, textures)), properties, clean + body)


def _read_properties(path: Path, lines: list[bytes]) -> dict[str, list[str]]:
    properties: dict[str, list[str]] = {}
    for line in lines:
        words = line.decode("latin-1").split()
        if words[0] == "element" and len(words) == 3:
            properties[words[1]] = []
        elif words[0] == "property" and properties:
            properties[next(reversed(properties))].append(words[-1])
    if "tristrips" in properties:
        raise _refuse(path, "its faces are strips of triangles; export it with single triangles")
    faces = properties.get("face")
    if faces and not any(name in faces for name in _INDICES):
        raise _refuse(
            path,
            f"its faces have no property {_INDICES[0]} among {', '.join(faces)}; export it again",
        )
    return properties


def _refuse(path: Path, fault: str) -> InputError:
    return InputError(f"{path} cannot be read as a mesh: {fault}.")
