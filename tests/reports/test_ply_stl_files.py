"""PLY and STL files in every way that tools write them give one mesh, or a sentence."""

import struct
from pathlib import Path

import numpy as np
import pytest

from skinnet.errors import InputError
from skinnet.mesh import Mesh, read_mesh

VERTICES = np.array([[0, 0, 0], [2, 0, 0], [2, 2, 1], [0, 2, 0], [1, 3, 0.5]], np.float64)
FACES = [[0, 1, 2], [0, 2, 3], [3, 2, 4]]
UV = np.array([[0, 0], [1, 0], [1, 0.75], [0, 0.75], [0.5, 1]], np.float64)


def header(kind: str, vertex: str, face: str, *, faces: int = 3, remarks: str = "") -> str:
    return (
        f"ply\nformat {kind} 1.0\n{remarks}element vertex 5\n{vertex}element face {faces}\n{face}"
        "end_header\n"
    )


def declare(kind: str, *names: str) -> str:
    return "".join(f"property {kind} {name}\n" for name in names)


XYZ = declare("float", "x", "y", "z")
LIST = "property list uchar int vertex_indices\n"


def rows(*columns: object) -> str:
    """Rows of text, each the values of its columns."""
    lines = [np.concatenate([np.atleast_1d(v) for v in row]) for row in zip(*columns, strict=True)]  # type: ignore[call-overload]
    return "".join(" ".join(f"{value:g}" for value in line) + "\n" for line in lines)


def write_text(vertex: str = XYZ, face: str = LIST, body: str = "", **more: object) -> str:
    return header("ascii", vertex, face, **more) + (body or rows(VERTICES) + FACE_ROWS)  # type: ignore[arg-type]


FACE_ROWS = rows([3] * 3, FACES)
PLAIN = write_text()
CORNERS = rows([3] * 3, FACES, [6] * 3, UV[FACES].reshape(3, 6))


def pack(order: str, real: str = "f", index: str = "i", length: str = "B") -> bytes:
    """Vertices and faces in binary."""
    body = b"".join(struct.pack(f"{order}3{real}", *vertex) for vertex in VERTICES)
    return body + b"".join(struct.pack(f"{order}{length}3{index}", 3, *face) for face in FACES)


def read(folder: Path, content: str | bytes, name: str = "a.ply") -> Mesh:
    (folder / name).write_bytes(content if isinstance(content, bytes) else content.encode())
    return read_mesh(folder / name)


def assert_plain(mesh: Mesh, mapped: bool = False) -> None:
    assert np.array_equal(mesh.vertices, VERTICES)
    assert mesh.triangles.tolist() == FACES
    if mapped:
        assert mesh.uv is not None and mesh.uv_triangles is not None
        assert np.array_equal(mesh.uv[mesh.uv_triangles], UV[FACES])
    else:
        assert mesh.uv is None


SHORTER = "property list uint8 uint8 vertex_index\n"
UNMAPPED: dict[str, str | bytes] = {
    "text": PLAIN,
    "CR LF": PLAIN.replace("\n", "\r\n"),
    "CR": PLAIN.replace("\n", "\r"),
    "tabs": PLAIN.replace(" ", "\t"),
    "one line": PLAIN.replace(
        rows(VERTICES) + FACE_ROWS, (rows(VERTICES) + FACE_ROWS).replace("\n", " ")
    ),
    "remarks": write_text(remarks="comment Größe\nobj_info x\ncomment\ncomment element face 9\n"),
    "vertex_index": write_text(face=LIST.replace("indices", "index")),
    "y before x": write_text(
        vertex=declare("double", "y", "x", "z"), body=rows(VERTICES[:, [1, 0, 2]]) + FACE_ROWS
    ),
    "normals and colours": write_text(
        vertex=XYZ + declare("float", "nx", "ny", "nz") + declare("uchar", "red", "green", "blue"),
        body=rows(VERTICES, [[0, 0, 1, 200, 100, 90]] * 5) + FACE_ROWS,
    ),
    "confidence": write_text(
        vertex=declare("float", "confidence") + XYZ, body=rows([0.5] * 5, VERTICES) + FACE_ROWS
    ),
    "flags of faces": write_text(
        face=declare("int", "flags") + LIST + declare("uchar", "red"),
        body=rows(VERTICES) + rows([7] * 3, [3] * 3, FACES, [9] * 3),
    ),
    "edges": write_text().replace("end_header\n", "element edge 1\nproperty int a\nend_header\n")
    + "4\n",
    "faces first": header("ascii", XYZ, LIST).replace(
        "element vertex 5\n" + XYZ + "element face 3\n" + LIST,
        "element face 3\n" + LIST + "element vertex 5\n" + XYZ,
    )
    + FACE_ROWS
    + rows(VERTICES),
    "quads and triangles": write_text(faces=2, body=rows(VERTICES) + "4 0 1 2 3\n3 3 2 4\n"),
    "triangles and quads": write_text(
        faces=2, body=rows(VERTICES) + "3 0 1 2\n4 0 2 4 3\n"
    ).replace("4 0 2 4 3", "4 3 0 2 4"),
    "points and lines": write_text(faces=5, body=rows(VERTICES) + "2 0 1\n" + FACE_ROWS + "1 4\n"),
    "little-endian": header("binary_little_endian", XYZ, LIST).encode() + pack("<"),
    "big-endian": header("binary_big_endian", XYZ, LIST).encode() + pack(">"),
    "double": header("binary_little_endian", XYZ.replace("float", "float64"), LIST).encode()
    + pack("<", "d"),
    "short indices": header("binary_big_endian", XYZ, SHORTER).encode() + pack(">", "f", "B"),
    "long lengths": header(
        "binary_little_endian", XYZ, "property list int uint vertex_indices\n"
    ).encode()
    + pack("<", "f", "I", "i"),
    "binary, CR LF": header("binary_little_endian", XYZ, LIST).replace("\n", "\r\n").encode()
    + pack("<"),
    "binary, CR": header("binary_little_endian", XYZ, LIST).replace("\n", "\r").encode()
    + pack("<"),
    "binary, Latin-1": header("binary_little_endian", XYZ, LIST, remarks="comment ä\n").encode(
        "latin-1"
    )
    + pack("<"),
    "binary, mixed": header("binary_little_endian", XYZ, LIST, faces=2).encode()
    + pack("<")[:60]
    + struct.pack("<B4i", 4, 0, 1, 2, 3)
    + struct.pack("<B3i", 3, 3, 2, 4),
}
NAMES = [("s", "t"), ("u", "v"), ("texture_u", "texture_v"), ("texture_s", "texture_t")]
TEXCOORD = "property list uchar float texcoord\n"
MAPPED = {
    **{
        " ".join(names): write_text(
            vertex=XYZ + declare("float", *names), body=rows(VERTICES, UV) + FACE_ROWS
        )
        for names in NAMES
    },
    "texcoord": write_text(face=LIST + TEXCOORD, body=rows(VERTICES) + CORNERS),
    "texcoord of quads": write_text(
        face=LIST + TEXCOORD,
        faces=2,
        body=rows(VERTICES)
        + rows([[4, 0, 1, 2, 3, 8]], [UV[:4].ravel()])
        + rows([[3, 3, 2, 4, 6]], [UV[[3, 2, 4]].ravel()]),
    ),
    "texcoord and texnumber": write_text(
        face=LIST + TEXCOORD + declare("int", "texnumber"),
        body=rows(VERTICES) + CORNERS.replace("\n", " 0\n"),
    ),
}


@pytest.mark.parametrize("kind", UNMAPPED)
def test_ply(tmp_path: Path, kind: str) -> None:
    mesh = read(tmp_path, UNMAPPED[kind])
    if kind == "triangles and quads":
        assert mesh.triangles.tolist() == [[0, 1, 2], [3, 0, 2], [3, 2, 4]]
    else:
        assert_plain(mesh)


@pytest.mark.parametrize("kind", MAPPED)
def test_ply_with_texture_coordinates(tmp_path: Path, kind: str) -> None:
    assert_plain(read(tmp_path, MAPPED[kind]), True)


def test_a_concave_polygon_of_a_ply_is_covered_once(tmp_path: Path) -> None:
    body = "0 0 0\n4 0 0\n4 4 0\n3 1 0\n9 9 9\n4 0 1 2 3\n"
    mesh = read(tmp_path, write_text(faces=1, body=body))
    assert sorted(map(sorted, mesh.triangles.tolist())) == [[0, 1, 3], [1, 2, 3]]


FAULTS: dict[str, tuple[str | bytes, str]] = {
    "a face short": (PLAIN.removesuffix("3 3 2 4\n"), "ends before all of its 3 elements 'face'"),
    "a number short": (PLAIN.removesuffix(" 4\n"), "ends before all of its 3 elements 'face'"),
    "no faces left": (PLAIN[: -len(FACE_ROWS)], "ends before all of its 3 elements 'face'"),
    "binary, cut": (
        header("binary_little_endian", XYZ, LIST).encode() + pack("<")[:-1],
        "ends before all of its 3 elements 'face'",
    ),
    "binary, vertices cut": (
        header("binary_little_endian", XYZ, LIST).encode() + pack("<")[:50],
        "ends before all of its 5 elements 'vertex'",
    ),
    "a word": (PLAIN.replace("2 2 1", "2 two 1"), "a word where a number belongs"),
    "a negative index": (PLAIN.replace("3 3 2 4", "3 3 2 -4"), "a face with vertex -4"),
    "an index beyond": (PLAIN.replace("3 3 2 4", "3 3 2 5"), "a face with vertex 5"),
    "no end of the header": (PLAIN.replace("end_header\n", ""), "does not end"),
    "another first line": ("plx\n" + PLAIN[4:], "does not begin with ply"),
    "an unknown type": (PLAIN.replace("float x", "quad x"), "the line 'property quad x'"),
    "an unknown format": (PLAIN.replace("ascii", "zipped"), "the line 'format zipped"),
    "no z": (PLAIN.replace("float z", "float w"), "no x, y and z"),
    "another name of the corners": (PLAIN.replace("vertex_indices", "corners"), "among corners"),
    "strips": (PLAIN.replace("element face", "element tristrips"), "strips of triangles"),
    "points": (write_text(faces=0, body=rows(VERTICES)), "has no faces, only 5 points"),
    "one coordinate a corner": (
        write_text(face=LIST + TEXCOORD, body=rows(VERTICES) + CORNERS.replace(" 6 ", " 3 ")),
        "ends before|texture coordinates",
    ),
    "empty": ("", "does not begin with ply"),
}


@pytest.mark.parametrize("kind", FAULTS)
def test_faults_of_ply_are_named(tmp_path: Path, kind: str) -> None:
    content, fault = FAULTS[kind]
    with pytest.raises(InputError, match=rf"a\.ply .*({fault})"):
        read(tmp_path, content)


def facets(order: str = "outer loop") -> str:
    loops = [
        f"facet normal 0 0 1\n  {order}\n"
        + "".join("    vertex {:.6e} {:g} {:g}\n".format(*VERTICES[i]) for i in face)
        + "  endloop\nendfacet\n"
        for face in FACES
    ]
    return "solid a face 1 2\n" + "".join(loops) + "endsolid a face 1 2\n"


def pack_facets(head: bytes, count: int = 3) -> bytes:
    body = [struct.pack("<12fH", 0, 0, 1, *VERTICES[face].ravel(), 7) for face in FACES]
    return head.ljust(80, b" ") + struct.pack("<I", count) + b"".join(body)


TEXT = facets()
STL: dict[str, str | bytes] = {
    "text": TEXT,
    "CR LF": TEXT.replace("\n", "\r\n"),
    "CR": TEXT.replace("\n", "\r"),
    "tabs": TEXT.replace("  ", "\t"),
    "upper case": TEXT.upper(),
    "no name": TEXT.replace(" a face 1 2", ""),
    "a name of words of the format": TEXT.replace("a face 1 2", "facet vertex"),
    "two solids": TEXT.replace("endfacet\n", "endfacet\nendsolid a\nsolid b\n", 1),
    "no end": TEXT.replace("endsolid a face 1 2\n", ""),
    "one line": "solid a\n"
    + TEXT.split("\n", 1)[1].replace("\n", " ").replace("endsolid", "\nendsolid"),
    "binary": pack_facets(b"exported"),
    "binary that begins with solid": pack_facets(b"solid facet normal"),
    "binary with zeros": pack_facets(b"\0\0"),
    "binary with bytes behind it": pack_facets(b"exported") + b"\0\0\0",
}


@pytest.mark.parametrize("kind", STL)
def test_stl(tmp_path: Path, kind: str) -> None:
    mesh = read(tmp_path, STL[kind], "a.stl")
    assert np.array_equal(mesh.vertices, VERTICES)
    assert mesh.triangles.tolist() == FACES


STL_FAULTS: dict[str, str | bytes] = {
    "text, cut": TEXT[: TEXT.rindex("vertex")],
    "text, a corner short": TEXT.replace("    vertex 0.000000e+00 2 0\n", "", 1),
    "text, a word": TEXT.replace("vertex 2.000000e+00", "vertex two", 1),
    "binary, cut": pack_facets(b"exported")[:-20],
    "binary, cut in its head": pack_facets(b"exported")[:60],
    "binary, no count": pack_facets(b"exported", 0),
    "binary, too small a count": pack_facets(b"exported", 2),
    "empty": "",
    "another text": "a photograph",
}


@pytest.mark.parametrize("kind", STL_FAULTS)
def test_faults_of_stl_are_named(tmp_path: Path, kind: str) -> None:
    with pytest.raises(InputError, match=r"a\.stl (cannot be read as a mesh|has no faces)"):
        read(tmp_path, STL_FAULTS[kind], "a.stl")
