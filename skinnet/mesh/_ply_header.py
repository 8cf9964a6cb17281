"""Headers of PLY files: elements, properties, and the pictures that they name."""

import re
from pathlib import Path
from typing import NamedTuple

from skinnet.errors import InputError

_END = re.compile(rb"(?m)^[ \t]*end_header[ \t]*(?:\r\n|\n|\r|$)")
_TEXTURE = re.compile(rb"(?i)(?:comment|obj_info)\s+texturefile:?\s+(.*)")
_REMARK = re.compile(rb"(?i)(?:comment|obj_info)\b")
_ORDERS = {"ascii": "", "binary_little_endian": "<", "binary_big_endian": ">"}
_TYPES = {
    **{"char": "i1", "uchar": "u1", "short": "i2", "ushort": "u2", "int": "i4", "uint": "u4"},
    **{"int8": "i1", "uint8": "u1", "int16": "i2", "uint16": "u2", "int32": "i4", "uint32": "u4"},
    **{"int64": "i8", "uint64": "u8", "float": "f4", "double": "f8"},
    **{"float16": "f2", "float32": "f4", "float64": "f8"},
}


class PlyProperty(NamedTuple):
    """A property of an element; `length` is the type of a list's length, "" for one value."""

    name: str
    kind: str
    length: str


class PlyElement(NamedTuple):
    """An element, and how often it occurs."""

    name: str
    length: int
    properties: list[PlyProperty]


class PlyHeader(NamedTuple):
    """The header of a PLY file.

    Attributes:
        order: Byte order of the numbers, < or >; "" where they are text.
        elements: The elements in their order.
        textures: Names of pictures, in their order.
    """

    order: str
    elements: list[PlyElement]
    textures: list[bytes]


def split_ply(path: Path, content: bytes) -> tuple[PlyHeader, bytes]:
    """Split a PLY file into its header, which is parsed, and its body.

    Raises:
        InputError: If the header is damaged.
    """
    end = _END.search(content.replace(b"\r", b"\n"))
    if not content[:8].lstrip().lower().startswith(b"ply") or end is None:
        raise refuse_ply(path, "its header does not begin with ply, or does not end")
    stop = end.end() + (content[end.end() - 1 : end.end() + 1] == b"\r\n")
    lines = [line.strip() for line in re.split(rb"[\r\n]+", content[: end.start()])]
    textures = [found[1] for line in lines if (found := _TEXTURE.match(line))]
    header = PlyHeader("", [], textures)
    for line in filter(None, lines[1:]):
        if not _REMARK.match(line):
            header = _add_line(path, header, line.decode("latin-1").split())
    return header, content[stop:]


def refuse_ply(path: Path, fault: str) -> InputError:
    """Make the error of a file that cannot be read."""
    return InputError(f"{path} cannot be read as a mesh: {fault}; export it again.")


def _add_line(path: Path, header: PlyHeader, words: list[str]) -> PlyHeader:
    match [words[0].lower(), *words[1:]]:
        case ["format", name, *_] if name.lower() in _ORDERS:
            return header._replace(order=_ORDERS[name.lower()])
        case ["element", name, length] if length.isdecimal():
            header.elements.append(PlyElement(name, int(length), []))
            return header
        case ["property", "list", count, kind, name] if header.elements:
            if count in _TYPES and kind in _TYPES:
                one = PlyProperty(name, _TYPES[kind], _TYPES[count])
                header.elements[-1].properties.append(one)
                return header
        case ["property", kind, name] if header.elements and kind in _TYPES:
            header.elements[-1].properties.append(PlyProperty(name, _TYPES[kind], ""))
            return header
    raise refuse_ply(path, f"its header has the line {' '.join(words)[:60]!r}")
