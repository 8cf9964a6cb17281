"""Mesh files: OBJ, PLY, STL and glTF, damaged and written from their grammars."""

import base64
import json
import struct
import tempfile
from functools import cache
from pathlib import Path
from random import Random

import numpy as np

from benchmarks.fuzzing.case import Case
from benchmarks.fuzzing.changes import change_bytes, change_text, change_value
from benchmarks.fuzzing.small_shapes import make_dome
from skinnet.mesh import read_mesh, repair_mesh, write_mesh

_WORDS = {
    ".obj": (
        b"v vt vn f o g s usemtl mtllib l p vp curv cstype 1/1/1 1//1 1/ -1 -1/-1 0 99999999 nan "
        b'9999999999999999999 1e400 face.mtl /etc/passwd ../a.mtl \\ # "a b.mtl"'
    ).split(),
    ".mtl": (
        b"newmtl skin map_Kd Kd Ka d illum face.png absent.png /dev/zero ../../x.png -s 1 -o "
        b"-clamp on -bm nan 1e400 . .."
    ).split(),
    ".ply": (
        b"ply format ascii binary_little_endian binary_big_endian 1.0 element vertex face property "
        b"list uchar char int uint short ushort float double int8 float64 x y z nx red green blue "
        b"vertex_indices vertex_index texcoord s t comment TextureFile end_header 0 -1 4294967295 "
        b"99999999999"
    ).split(),
    ".stl": b"solid facet normal outer loop vertex endloop endfacet endsolid nan 1e400 0".split(),
}


def make(rng: Random) -> Case:
    """Make a mesh with its files, which is read and repaired."""
    kind = rng.choice(("obj", "obj", "ply", "plain ply", "stl", "plain stl", "glb", "gltf", "new"))
    files = dict(make_files()[kind]) if kind != "new" else _write_new(rng)
    name, textured = next(iter(files)), rng.random() < 0.5
    target = rng.choice([name, name, name, *files])
    if kind != "new" or rng.random() < 0.3:
        files[target] = _change(target, files[target], rng)
    return Case(lambda folder: _read(folder / name, textured), files, name)


def _read(path: Path, textured: bool) -> None:
    mesh = read_mesh(path)
    _check(mesh.vertices, mesh.triangles)
    if mesh.uv is not None and mesh.uv_triangles is not None:
        assert 0 <= mesh.uv_triangles.min() and mesh.uv_triangles.max() < len(mesh.uv)
    repaired = repair_mesh(mesh, textured).mesh
    _check(repaired.vertices, repaired.triangles)
    assert np.isfinite(repaired.vertices).all()
    if textured:
        assert repaired.uv is not None and np.isfinite(repaired.uv).all()


def _check(vertices: np.ndarray, triangles: np.ndarray) -> None:
    assert vertices.ndim == 2 and vertices.shape[1] == 3
    assert len(triangles) and 0 <= triangles.min() and triangles.max() < len(vertices)


def _change(name: str, data: bytes, rng: Random) -> bytes:
    suffix = Path(name).suffix
    if suffix in (".glb", ".gltf") and rng.random() < 0.8:
        return _change_document(name, data, rng)
    if suffix == ".ply" and rng.random() < 0.7:
        head, mark, body = data.partition(b"end_header\n")
        return change_text(head, rng, tuple(_WORDS[suffix])) + mark + body
    if suffix in _WORDS and rng.random() < 0.8:
        return change_text(data, rng, tuple(_WORDS[suffix]))
    return change_bytes(data, rng)


def _change_document(name: str, data: bytes, rng: Random) -> bytes:
    if name.endswith(".gltf"):
        return json.dumps(_change_often(json.loads(data), rng)).encode()
    (length,) = struct.unpack_from("<I", data, 12)
    document = _change_often(json.loads(data[20 : 20 + length]), rng)
    return _pack_glb(document, data[28 + length :])


def _change_often(document: object, rng: Random) -> object:
    for _ in range(rng.choice((1, 1, 2, 4))):
        document = change_value(document, rng)
    return document


def _pack_glb(document: object, binary: bytes) -> bytes:
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    body = struct.pack("<II", len(text), 0x4E4F534A) + text
    body += struct.pack("<II", len(binary), 0x004E4942) + binary
    return struct.pack("<4sII", b"glTF", 2, 12 + len(body)) + body


@cache
def make_files() -> dict[str, dict[str, bytes]]:
    """Files of each kind; the mesh is the first."""
    with tempfile.TemporaryDirectory() as folder:
        found = {}
        for suffix in (".obj", ".ply"):
            place = Path(folder, suffix)
            place.mkdir()
            write_mesh(place / f"face{suffix}", make_dome())
            files = {each.name: each.read_bytes() for each in place.iterdir()}
            first = f"face{suffix}"
            found[suffix[1:]] = {first: files.pop(first), **files}
    picture = found["obj"]["face.png"]
    return found | {
        "plain ply": {"face.ply": _write_plain_ply()},
        "stl": {"face.stl": _write_stl()},
        "plain stl": {"face.stl": _write_plain_stl()},
        "glb": {"face.glb": _pack_glb(*_make_document(picture))},
        "gltf": _write_gltf(picture),
    }


def _write_plain_ply() -> bytes:
    mesh = make_dome()
    lines = ["ply", "format ascii 1.0", "comment a face", f"element vertex {len(mesh.vertices)}"]
    lines += [f"property float {name}" for name in "xyz"]
    lines += [f"property uchar {name}" for name in ("red", "green", "blue")]
    lines += [f"element face {len(mesh.triangles)}", "property list uchar int vertex_indices"]
    lines += ["end_header", *(f"{x:.6g} {y:.6g} {z:.6g} 200 150 130" for x, y, z in mesh.vertices)]
    lines += [f"3 {a} {b} {c}" for a, b, c in mesh.triangles]
    return ("\n".join(lines) + "\n").encode()


def _write_stl() -> bytes:
    corners = make_dome().vertices[make_dome().triangles].astype("<f4")
    rows = np.zeros(len(corners), [("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("a", "<u2")])
    rows["corners"] = corners
    return b"a face".ljust(80) + struct.pack("<I", len(corners)) + rows.tobytes()


def _write_plain_stl() -> bytes:
    facets = [
        "facet normal 0 0 1\nouter loop\n"
        + "".join(f"vertex {x:.6g} {y:.6g} {z:.6g}\n" for x, y, z in corners)
        + "endloop\nendfacet\n"
        for corners in make_dome().vertices[make_dome().triangles]
    ]
    return ("solid face\n" + "".join(facets) + "endsolid face\n").encode()


def _make_document(picture: bytes) -> tuple[dict[str, object], bytes]:
    mesh = make_dome()
    arrays = [
        mesh.vertices.astype("<f4"),
        np.asarray(mesh.uv, "<f4"),
        mesh.triangles.ravel().astype("<u2"),
        np.eye(4, dtype="<f4").reshape(1, 16),
    ]
    blobs = [*(each.tobytes() for each in arrays), picture]
    starts = np.cumsum([0, *(len(each) + -len(each) % 4 for each in blobs)]).tolist()
    kinds = ((5126, "VEC3"), (5126, "VEC2"), (5123, "SCALAR"), (5126, "MAT4"))
    document: dict[str, object] = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [
            {"children": [1, 2]},
            {"mesh": 0, "skin": 0, "rotation": [0, 0, 0, 1]},
            {"translation": [0, 0, 1], "scale": [1, 1, 1]},
        ],
        "skins": [{"joints": [2], "inverseBindMatrices": 3}],
        "meshes": [
            {
                "primitives": [
                    {
                        "attributes": {"POSITION": 0, "TEXCOORD_0": 1},
                        "indices": 2,
                        "material": 0,
                        "mode": 4,
                    }
                ]
            }
        ],
        "accessors": [
            {"bufferView": at, "componentType": component, "type": kind, "count": len(arrays[at])}
            for at, (component, kind) in enumerate(kinds)
        ],
        "bufferViews": [
            {"buffer": 0, "byteOffset": start, "byteLength": len(each)}
            for start, each in zip(starts, blobs, strict=False)
        ],
        "images": [{"bufferView": 4, "mimeType": "image/png"}],
        "textures": [{"source": 0, "sampler": 0}],
        "samplers": [{"wrapS": 10497, "wrapT": 33071}],
        "materials": [
            {
                "pbrMetallicRoughness": {
                    "baseColorTexture": {"index": 0},
                    "baseColorFactor": [1, 1, 1, 1],
                }
            }
        ],
        "buffers": [{"byteLength": starts[-1]}],
    }
    return document, b"".join(each + bytes(-len(each) % 4) for each in blobs)


def _write_gltf(picture: bytes) -> dict[str, bytes]:
    document, binary = _make_document(picture)
    packed = base64.b64encode(picture).decode()
    document["images"] = [{"uri": f"data:image/png;base64,{packed}"}]
    document["buffers"] = [{"byteLength": len(binary), "uri": "face.bin"}]
    return {"face.gltf": json.dumps(document).encode(), "face.bin": binary}


def _write_new(rng: Random) -> dict[str, bytes]:
    """Text from the words of a format, in lines that are mostly right."""
    return {"face.obj": _write_obj(rng)} if rng.random() < 0.5 else {"face.ply": _write_ply(rng)}


def _write_obj(rng: Random) -> bytes:
    count, lines = rng.choice((0, 1, 3, 5, 20)), []
    for _ in range(count):
        lines.append(b"v " + b" ".join(_number(rng) for _ in range(rng.choice((3, 3, 3, 4, 6, 2)))))
        lines.append(b"vt " + b" ".join(_number(rng) for _ in range(rng.choice((2, 2, 3, 1)))))
    for _ in range(rng.choice((0, 1, 4, 40))):
        form = rng.choice((b"%d", b"%d/%d", b"%d//%d", b"%d/%d/%d"))
        corners = [
            form % tuple(rng.randint(-count, count + 1) for _ in range(form.count(b"%")))
            for _ in range(rng.choice((3, 3, 4, 5, 2, 60)))
        ]
        lines.append(b"f " + b" ".join(corners))
    words = _WORDS[".obj"]
    extra = [b" ".join(rng.choices(words, k=rng.randint(1, 5))) for _ in range(rng.choice((0, 2)))]
    lines += extra
    if rng.random() < 0.3:
        rng.shuffle(lines)
    return rng.choice((b"\n", b"\r\n", b"\r")).join(lines)


def _write_ply(rng: Random) -> bytes:
    form = rng.choice(("ascii", "binary_little_endian", "binary_big_endian"))
    types = (
        "float",
        "double",
        "uchar",
        "int",
        "short",
        "uint",
        "char",
        "float32",
        "list uchar int",
    )
    lines = ["ply", f"format {form} 1.0"]
    elements = [
        ("vertex", "x y z nx s t red green blue alpha".split()),
        ("face", ["vertex_indices", "texcoord", "red", "texnumber"]),
        ("edge", ["vertex1", "vertex2"]),
    ]
    for name, properties in rng.sample(elements, rng.choice((1, 2, 2, 3))):
        lines.append(f"element {name} {rng.choice((0, 1, 3, 4, 50, 2**31, -1))}")
        for each in properties[: rng.randint(0, len(properties))]:
            kind = "list uchar int" if each in ("vertex_indices", "texcoord") else "float"
            lines.append(f"property {kind if rng.random() < 0.8 else rng.choice(types)} {each}")
    if form == "ascii":
        body = b"\n".join(
            b" ".join(_number(rng) for _ in range(rng.choice((3, 3, 4, 8)))) for _ in range(60)
        )
    else:
        body = rng.choice((rng.randbytes(900), bytes(2000), b"\x03\0\0\0\1\0\0\0\2\0\0\0" * 80))
    return "\n".join([*lines, "end_header\n"]).encode() + body


def _number(rng: Random) -> bytes:
    if rng.random() < 0.97:
        return b"%d" % rng.randint(0, 3) if rng.random() < 0.5 else b"%.3f" % rng.gauss(0, 50)
    return rng.choice(
        (b"nan", b"inf", b"1e300", b"-1e38", b"1e39", b"0x1", b"-", b"1,5", b"1e-320")
    )
