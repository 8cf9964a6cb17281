"""Wavefront OBJ files: vertices, texture coordinates, faces and the names of materials."""

import re
from pathlib import Path
from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float, Int

from skinnet.mesh._face_parts import Faces
from skinnet.mesh._obj_lines import (
    Lines,
    convert,
    count_by_line,
    cut_keyword,
    mark_words,
    parse_numbers,
    read_lines,
)
from skinnet.mesh._polygons import cut_polygons

_SLASH, _ZERO, _NINE, _CASE = ord("/"), ord("0"), ord("9"), 32
_SIGNS = (ord("+"), ord("-"))
_UNUSED = frozenset(
    b"o g s mg l p vn vp lod bevel c_interp d_interp shadow_obj trace_obj "
    b"ctech stech deg bmat step cstype parm trim hole scrv sp end con".split()
)
"""Statements that say nothing about a mesh of polygons and its materials."""
_REFUSED = {
    **dict.fromkeys(
        b"call csh".split(), "takes in another file, which is not read; write all into one file"
    ),
    **dict.fromkeys(
        b"maplib usemap".split(), "names a texture by usemap, which is not read; use mtllib"
    ),
    **dict.fromkeys(
        b"curv curv2 surf bzp bsp cdc cdp".split(),
        "has a curved surface, and polygons are read; convert it to them",
    ),
}


class Statement(NamedTuple):
    """The rest of a line after its keyword; lines count from 0."""

    line: int
    rest: bytes


class Corners(NamedTuple):
    """The corners of all faces in one row; `coordinate` is -1 where a corner has none."""

    vertex: Int[np.ndarray, "corners"]
    coordinate: Int[np.ndarray, "corners"]
    counts: Int[np.ndarray, "faces"]
    lines: Int[np.ndarray, "faces"]


class ObjFile(NamedTuple):
    """What an OBJ file says.

    `material` is the place in `materials` of each triangle's, -1 before the first.
    """

    faces: Faces
    material: Int[np.ndarray, "triangles"]
    materials: list[Statement]
    libraries: list[Statement]
    notes: list[str]


class _Kinds(NamedTuple):
    vertex: Bool[np.ndarray, "lines"]
    coordinate: Bool[np.ndarray, "lines"]
    face: Bool[np.ndarray, "lines"]
    other: Bool[np.ndarray, "lines"]


def read_obj(path: Path) -> ObjFile:
    """Read an OBJ file; polygons are cut into triangles.

    Raises:
        InputError: For a line that is damaged, an index out of range, or parts in other files.
    """
    lines = read_lines(path)
    kinds = _sort_lines(lines)
    vertices, notes = _read_vertices(lines, kinds.vertex)
    coordinates = _read_coordinates(lines, kinds.coordinate)
    materials, libraries, more = _read_others(lines, kinds.other)
    corners = _read_corners(lines, kinds)
    cut, face = cut_polygons(vertices[corners.vertex], corners.counts)
    used = np.searchsorted([each.line for each in materials], corners.lines) - 1
    few = int((corners.counts < 3).sum())
    notes += [f"{path}: {few:,} faces with fewer than three corners were left out."] * (few > 0)
    uv = corners.coordinate[cut]
    uv = np.where((uv < 0).any(1, keepdims=True), -1, uv)
    return ObjFile(
        Faces(vertices, coordinates, corners.vertex[cut], uv),
        used[face].astype(np.int64),
        *(materials, libraries, notes + more),
    )


def read_obj_positions(path: Path) -> Float[np.ndarray, "vertices 3"]:
    """Read the vertices of an OBJ file in its order, those without a face too."""
    lines = read_lines(path)
    return _read_vertices(lines, _sort_lines(lines).vertex)[0]


def _sort_lines(lines: Lines) -> _Kinds:
    first, second, third = (
        lines.text[np.minimum(lines.starts + place, lines.ends)] for place in range(3)
    )
    lower, then = first | _CASE, second | _CASE
    short, long = second <= 32, third <= 32
    vertex = (lower == ord("v")) & short & (first > 32)
    coordinate = (lower == ord("v")) & (then == ord("t")) & long
    # `fo` is the name of faces in old files.
    face = (lower == ord("f")) & (short | (then == ord("o")) & long)
    normal = (lower == ord("v")) & (then == ord("n")) & long
    passed = normal | (first <= 32) | (first == ord("#"))
    return _Kinds(vertex, coordinate, face, ~(vertex | coordinate | face | passed))


def _read_vertices(
    lines: Lines, chosen: Bool[np.ndarray, "lines"]
) -> tuple[Float[np.ndarray, "vertices 3"], list[str]]:
    numbers = parse_numbers(lines, chosen, 1)
    if (numbers.counts < 3).any():
        line = np.flatnonzero(chosen)[np.argmax(numbers.counts < 3)]
        raise lines.fault(int(line), "has a vertex with fewer than three coordinates")
    places = numbers.starts[:, None] + np.arange(3)
    notes, four = [], numbers.counts == 4
    if (numbers.values[numbers.starts[four] + 3] != 1).any():
        notes.append(
            f"{lines.path}: the fourth numbers of vertices are weights for curves, and were not "
            "used."
        )
    if (numbers.counts >= 6).any():
        notes.append(
            f"{lines.path} has colours at its vertices, which are not read; skin is read from a "
            "texture. Bake them into one if it has none."
        )
    return numbers.values[places].reshape(-1, 3), notes


def _read_coordinates(
    lines: Lines, chosen: Bool[np.ndarray, "lines"]
) -> Float[np.ndarray, "coordinates 2"]:
    numbers = parse_numbers(lines, chosen, 2)
    if (numbers.counts < 1).any():
        line = np.flatnonzero(chosen)[np.argmin(numbers.counts)]
        raise lines.fault(int(line), "has a texture coordinate without a number")
    second = np.minimum(numbers.starts + 1, max(len(numbers.values) - 1, 0))
    v = np.where(numbers.counts > 1, numbers.values[second], 0)
    return np.stack([numbers.values[numbers.starts], v], 1)


def _read_others(
    lines: Lines, chosen: Bool[np.ndarray, "lines"]
) -> tuple[list[Statement], list[Statement], list[str]]:
    materials: list[Statement] = []
    libraries: list[Statement] = []
    unknown: dict[str, int] = {}
    for line in np.flatnonzero(chosen).tolist():
        word, _, rest = lines.take(line).replace(b"\t", b" ").partition(b" ")
        keyword = word.lower()
        if keyword == b"usemtl":
            materials.append(Statement(line, rest.strip()))
        elif keyword == b"mtllib":
            libraries.append(Statement(line, rest.strip()))
        elif keyword not in _UNUSED:
            _check_keyword(lines, line, keyword)
            unknown.setdefault(keyword.decode(), line + 1)
    notes = [
        f"{lines.path}: the lines {word!r} (from line {line}) are no part of the OBJ format, and "
        "were passed over."
        for word, line in unknown.items()
    ]
    return materials, libraries, notes


def _check_keyword(lines: Lines, line: int, keyword: bytes) -> None:
    if keyword in _REFUSED:
        raise lines.fault(line, _REFUSED[keyword])
    if not re.fullmatch(rb"[a-z_]+\d?", keyword):
        start = lines.take(line)[:40].decode("utf-8", "replace")
        raise lines.fault(line, f"begins with no word of the OBJ format: {start!r}")


def _read_corners(lines: Lines, kinds: _Kinds) -> Corners:
    """Read `f` lines: words of one to three indices with slashes between them."""
    content = cut_keyword(lines, kinds.face, 1)
    if b"o" in content.lower():
        content = re.sub(rb"(?mi)^ o(?=\s)", b"  ", content)
    text, at = np.frombuffer(content, np.uint8), np.flatnonzero(kinds.face)
    slash, word = text == _SLASH, mark_words(text)
    number = (text > 32) & ~slash
    begun = number & ~np.append(False, number[:-1])[: len(number)]
    digit = (text >= _ZERO) & (text <= _NINE)
    wrong = number & ~digit & ~(begun & np.isin(text, _SIGNS)) | word & slash
    slashes, place = np.cumsum(slash, dtype=np.int32), np.flatnonzero(begun)
    owner = np.cumsum(word, dtype=np.int32)[place] - 1
    slot = slashes[place] - slashes[np.flatnonzero(word)][owner]
    wrong[place[slot > 2]] = True
    values = convert(content.replace(b"/", b" "), np.int64)
    if wrong.any() or len(values) != len(place):
        at_fault = int(np.argmax(wrong)) if wrong.any() else len(content)
        line = int(at[min(content[:at_fault].count(b"\n"), len(at) - 1)])
        shown = lines.take(line)[:60].decode("utf-8", "replace")
        raise lines.fault(line, f"is a face that cannot be read: {shown!r}")
    counts = count_by_line(content, word)
    on_line = np.repeat(np.arange(len(at)), counts)
    vertex = _resolve(lines, kinds.vertex, at[on_line], values[slot == 0], "vertex")
    second = slot == 1
    coordinate = np.full(len(vertex), -1)
    coordinate[owner[second]] = _resolve(
        *(lines, kinds.coordinate, at[on_line[owner[second]]], values[second]),
        "texture coordinate",
    )
    known = np.bincount(on_line[coordinate >= 0], minlength=len(at))
    some = (known > 0) & (known < counts)
    if some.any():
        line = int(at[np.argmax(some)])
        raise lines.fault(line, "has a face with texture coordinates at some of its corners only")
    return Corners(vertex, coordinate, counts, at)


def _resolve(
    lines: Lines,
    listed: Bool[np.ndarray, "lines"],
    at: Int[np.ndarray, "indices"],
    index: Int[np.ndarray, "indices"],
    what: str,
) -> Int[np.ndarray, "indices"]:
    """Resolve indices from 1, or from -1 back from the line that they are on."""
    before = np.cumsum(listed)
    count = int(listed.sum())
    found = np.where(index < 0, before[at] + index, index - 1)
    wrong = (found < 0) | (found >= count) | (index == 0)
    if wrong.any():
        one = int(np.argmax(wrong))
        line, value = int(at[one]), int(index[one])
        number = int(before[line]) if value < 0 else count
        known = f"{number:,} {'come before it' if value < 0 else 'are in the file'}"
        known = "they are counted from 1" if value == 0 else known
        raise lines.fault(line, f"has a face with {what} {value}, and {known}")
    return found
