"""glTF as tools write it: every face has the position and the base colour that its file states.

A square of two triangles is looked at from the front, as a viewer shows it: the right colours are
computed from the picture, the sampler and the factors alone.
"""

import base64
import io
import struct
from collections.abc import Callable
from pathlib import Path
from typing import Any
from urllib.parse import quote

import colour
import numpy as np
import pytest
import trimesh
from gltf_files import SQUARE, SQUARE_TRIANGLES, SQUARE_UV, GltfBuilder, checks, describe, encode
from PIL import Image

from skinnet.cli import main
from skinnet.errors import InputError
from skinnet.images._named_spaces import DISPLAY_P3
from skinnet.mesh import Mesh, read_mesh
from skinnet.mesh._sampling import sample_bilinear

PLACES = (np.arange(8) + 0.5) / 8
"""Where the square is looked at, along x and y."""


def look(mesh: Mesh, x: float, y: float) -> np.ndarray:
    """The colour of the mesh at (x, y), seen along -z."""
    assert mesh.texture is not None and mesh.uv is not None and mesh.uv_triangles is not None
    for triangle, uv in zip(mesh.vertices[mesh.triangles], mesh.uv[mesh.uv_triangles], strict=True):
        (ax, ay), b, c = triangle[0, :2], triangle[1, :2], triangle[2, :2]
        matrix = np.array([b - triangle[0, :2], c - triangle[0, :2]]).T
        second, third = np.linalg.solve(matrix, [x - ax, y - ay])
        weights = np.array([1 - second - third, second, third])
        if (weights >= -1e-9).all():
            return sample_bilinear(mesh.texture, (weights @ uv)[None])[0]
    raise AssertionError(f"nothing is at {x}, {y}")


def look_everywhere(mesh: Mesh) -> np.ndarray:
    """Colours at `PLACES`, [y, x, 3]."""
    return np.array([[look(mesh, x, y) for x in PLACES] for y in PLACES])


def wrap(value: float, mode: int) -> float:
    """Sampler addressing, from the OpenGL ES specification."""
    if mode == 33071:
        return min(max(value, 0.0), 1.0)
    if mode == 33648:
        turned = value % 2
        return turned if turned <= 1 else 2 - turned
    return value % 1


def show(
    picture: np.ndarray,
    matrix: Any = None,
    modes: tuple[int, int] = (10497, 10497),
    shift: tuple[float, float] = (0, 0),
) -> np.ndarray:
    """What a viewer shows of the square at `PLACES`: uv = (x, 1 - y), transformed, wrapped."""
    transform = np.eye(3) if matrix is None else np.asarray(matrix)
    rows, columns = picture.shape[:2]
    shown = np.empty((len(PLACES), len(PLACES), 3))
    for i, y in enumerate(PLACES):
        for j, x in enumerate(PLACES):
            u, v, _ = transform @ [x, 1 - y, 1]
            column = min(int(wrap(u + shift[0] / columns, modes[0]) * columns), columns - 1)
            row = min(int(wrap(v + shift[1] / rows, modes[1]) * rows), rows - 1)
            shown[i, j] = picture[row, column]
    return shown


def assert_shown(mesh: Mesh, picture: np.ndarray, matrix: Any, modes: Any = (10497, 10497)) -> None:
    """Compare wherever no border of two blocks is within a texel."""
    around = [show(picture, matrix, modes, (u, v)) for u in (-1, 0, 1) for v in (-1, 0, 1)]
    steady = np.ptp(around, 0).max(-1) == 0
    assert steady.mean() > 0.5
    assert np.abs(look_everywhere(mesh) - around[4])[steady].max() < 1


def decode(srgb: np.ndarray) -> np.ndarray:
    return colour.models.eotf_sRGB(np.asarray(srgb) / 255)


def multiply(srgb: np.ndarray, factor: Any) -> np.ndarray:
    """Multiply sRGB with a linear factor."""
    return 255 * colour.models.eotf_inverse_sRGB(decode(srgb) * np.asarray(factor)[..., :3])


def textured(picture: np.ndarray, **base: Any) -> GltfBuilder:
    """A square with a picture."""
    made = GltfBuilder()
    made.add_square(made.add_material(made.add_picture(encode(picture)), **base))
    return made


def base_texture(made: GltfBuilder) -> dict[str, Any]:
    return made.document["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]


def primitive(made: GltfBuilder) -> dict[str, Any]:
    return made.document["meshes"][0]["primitives"][0]


@pytest.mark.parametrize("form", ["glb", "data URI", "files", "gltf that is a glb", "glb as text"])
def test_a_plain_file_in_every_container(tmp_path: Path, form: str) -> None:
    picture = checks()
    made = textured(picture)
    if form == "glb":
        path = made.write_glb(tmp_path / "a.glb")
    elif form == "gltf that is a glb":
        path = made.write_glb(tmp_path / "a.gltf")
    elif form == "glb as text":
        path = made.write_gltf(tmp_path / "a.glb")
    else:
        path = made.write_gltf(tmp_path / "a.gltf", None if form == "data URI" else "a.bin")
    mesh = read_mesh(path)
    assert np.array_equal(mesh.vertices, SQUARE) and mesh.triangles.tolist() == [
        [0, 1, 2],
        [0, 2, 3],
    ]
    assert np.array_equal(mesh.texture, picture) and mesh.notes == ()
    assert np.allclose(mesh.uv[mesh.uv_triangles[0]], [[0, 0], [1, 0], [1, 1]])
    assert np.array_equal(look_everywhere(mesh), show(picture))


@pytest.mark.parametrize("number", [1, 2, 7])
@pytest.mark.parametrize("by", ["textureInfo", "KHR_texture_transform"])
def test_the_set_of_texture_coordinates_is_that_of_the_base_colour(
    tmp_path: Path, number: int, by: str
) -> None:
    picture = checks()
    made = textured(picture)
    attributes = primitive(made)["attributes"]
    for other in range(number):
        attributes[f"TEXCOORD_{other}"] = made.add_array(0.3 * SQUARE_UV)
    attributes[f"TEXCOORD_{number}"] = made.add_array(SQUARE_UV)
    if by == "textureInfo":
        base_texture(made)["texCoord"] = number
    else:
        base_texture(made)["extensions"] = {by: {"texCoord": number}}
        made.require(by)
    assert np.array_equal(
        look_everywhere(read_mesh(made.write_glb(tmp_path / "a.glb"))), show(picture)
    )


def rotate(angle: float) -> np.ndarray:
    """Counter-clockwise as seen on the picture, whose v points down."""
    cos, sin = np.cos(angle), np.sin(angle)
    return np.array([[cos, sin, 0], [-sin, cos, 0], [0, 0, 1]])


@pytest.mark.parametrize("required", [True, False])
@pytest.mark.parametrize(
    ("transform", "matrix"),
    [
        ({"offset": [0.25, 0.5]}, [[1, 0, 0.25], [0, 1, 0.5], [0, 0, 1]]),
        ({"scale": [0.5, 0.25]}, [[0.5, 0, 0], [0, 0.25, 0], [0, 0, 1]]),
        ({"scale": [1, -1], "offset": [0, 1]}, [[1, 0, 0], [0, -1, 1], [0, 0, 1]]),
        ({"scale": [2, 3]}, [[2, 0, 0], [0, 3, 0], [0, 0, 1]]),
        # The extension's own example: the lower left quadrant, rotated clockwise.
        (
            {"offset": [0, 1], "rotation": np.pi / 2, "scale": [0.5, 0.5]},
            [[0, 0.5, 0], [-0.5, 0, 1], [0, 0, 1]],
        ),
        ({"rotation": np.pi}, [[-1, 0, 0], [0, -1, 0], [0, 0, 1]]),
        (
            {"offset": [0.1, 0.2], "rotation": 0.3, "scale": [1.5, 0.7]},
            np.array([[1, 0, 0.1], [0, 1, 0.2], [0, 0, 1]]) @ rotate(0.3) @ np.diag([1.5, 0.7, 1]),
        ),
    ],
)
def test_texture_transforms(tmp_path: Path, transform: Any, matrix: Any, required: bool) -> None:
    picture = checks(side=64)
    made = textured(picture)
    base_texture(made)["extensions"] = {"KHR_texture_transform": transform}
    if required:
        made.require("KHR_texture_transform")
    assert_shown(read_mesh(made.write_glb(tmp_path / "a.glb")), picture, matrix)


@pytest.mark.parametrize("modes", [(10497, 10497), (33648, 33648), (33071, 33071), (33071, 33648)])
@pytest.mark.parametrize("scale", [(2.0, 2.0), (0.3, 3.1), (-1.3, 1.7), (1.004, 1.004)])
@pytest.mark.parametrize("offset", [(0.0, 0.0), (0.37, -1.26), (-5.13, 4.21)])
def test_samplers_repeat_mirror_and_clamp(
    tmp_path: Path, modes: tuple[int, int], scale: Any, offset: Any
) -> None:
    picture = checks(2, 3, side=40)
    made = textured(picture)
    made.add("samplers", wrapS=modes[0], wrapT=modes[1])
    made.document["textures"][0]["sampler"] = 0
    uv = (SQUARE_UV * scale + offset).astype(np.float32)
    primitive(made)["attributes"]["TEXCOORD_0"] = made.add_array(uv)
    mesh = read_mesh(made.write_glb(tmp_path / "a.glb"))
    assert mesh.uv.min() >= 0 and mesh.uv.max() <= 1
    matrix = [[scale[0], 0, offset[0]], [0, scale[1], offset[1]], [0, 0, 1]]
    assert_shown(mesh, picture, matrix, modes)


def test_whole_tiles_do_not_enlarge_the_picture(tmp_path: Path) -> None:
    picture = checks()
    made = textured(picture)
    uv = SQUARE_UV + np.array([3, -2], np.float32)
    primitive(made)["attributes"]["TEXCOORD_0"] = made.add_array(uv)
    mesh = read_mesh(made.write_glb(tmp_path / "a.glb"))
    assert np.array_equal(mesh.texture, picture)
    assert np.array_equal(look_everywhere(mesh), show(picture))


@pytest.mark.parametrize("factor", [[0.5, 0.25, 1.0, 1.0], [0.8, 0.8, 0.8, 1.0], [0, 1, 0.01, 0.3]])
@pytest.mark.parametrize("by", ["metallic-roughness", "specular-glossiness", "COLOR_0", "both"])
def test_factors_multiply_linear_colours(tmp_path: Path, factor: list[float], by: str) -> None:
    picture = checks()
    made = textured(picture)
    material = made.document["materials"][0]
    if by == "specular-glossiness":
        texture = material.pop("pbrMetallicRoughness")["baseColorTexture"]
        stated = {"diffuseTexture": texture, "diffuseFactor": factor}
        material["extensions"] = {"KHR_materials_pbrSpecularGlossiness": stated}
        made.require("KHR_materials_pbrSpecularGlossiness")
    if by in ("metallic-roughness", "both"):
        material["pbrMetallicRoughness"]["baseColorFactor"] = factor
    if by in ("COLOR_0", "both"):
        values = np.tile(np.array(factor, np.float32), (4, 1))
        primitive(made)["attributes"]["COLOR_0"] = made.add_array(values)
    seen = look_everywhere(read_mesh(made.write_glb(tmp_path / "a.glb")))
    total = np.square(factor) if by == "both" else factor
    assert np.abs(seen - multiply(show(picture), total)).max() <= 1


@pytest.mark.parametrize("kind", ["f4", "u1", "u2"])
@pytest.mark.parametrize("channels", [3, 4])
@pytest.mark.parametrize("with_picture", [True, False])
def test_vertex_colours_are_interpolated_in_linear_light(
    tmp_path: Path, kind: str, channels: int, with_picture: bool
) -> None:
    picture = checks(side=32) if with_picture else np.full((1, 1, 3), 255, np.uint8)
    made = textured(picture)
    if not with_picture:
        del made.document["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]
    # Linear over the square, so that both triangles continue each other.
    corners = np.array([[0.2, 0.1, 0.9, 1], [1, 0.1, 0.7, 1], [1, 0.5, 0.5, 1], [0.2, 0.5, 0.7, 1]])
    top = 1 if kind == "f4" else np.iinfo(kind).max
    values = (corners * top if kind == "f4" else np.rint(corners * top)).astype(kind)
    number = made.add_array(values[:, :channels], normalized=kind != "f4")
    primitive(made)["attributes"]["COLOR_0"] = number
    x, y = np.meshgrid(PLACES, PLACES)
    stored = values[:, :3] / top
    factor = (
        stored[0] + x[..., None] * (stored[1] - stored[0]) + y[..., None] * (stored[3] - stored[0])
    )
    seen = look_everywhere(read_mesh(made.write_glb(tmp_path / "a.glb")))
    assert np.abs(seen - multiply(show(picture), factor)).max() <= 2.5


def test_vertex_colours_that_share_texels_are_refused(tmp_path: Path) -> None:
    made = textured(checks())
    uv = SQUARE_UV[[0, 1, 2, 1]]
    primitive(made)["attributes"]["TEXCOORD_0"] = made.add_array(uv)
    colours = np.array([[1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 1]], np.float32)
    primitive(made)["attributes"]["COLOR_0"] = made.add_array(colours)
    with pytest.raises(InputError, match=r"a\.glb: skin .*vertex colours \(COLOR_0\).*bake them"):
        read_mesh(made.write_glb(tmp_path / "a.glb"))


@pytest.mark.parametrize("kind", ["u1", "u2"])
def test_texture_coordinates_of_integers(tmp_path: Path, kind: str) -> None:
    picture = checks()
    made = textured(picture)
    values = (SQUARE_UV * np.iinfo(kind).max).astype(kind)
    attributes = primitive(made)["attributes"]
    attributes["TEXCOORD_0"] = made.add_array(values, normalized=True)
    assert np.array_equal(
        look_everywhere(read_mesh(made.write_glb(tmp_path / "a.glb"))), show(picture)
    )


@pytest.mark.parametrize("kind", ["i1", "u1", "i2", "u2"])
@pytest.mark.parametrize("normalised", [True, False])
def test_quantised_meshes(tmp_path: Path, kind: str, normalised: bool) -> None:
    picture = checks()
    made = textured(picture)
    made.require("KHR_mesh_quantization", "KHR_texture_transform")
    attributes, top = primitive(made)["attributes"], np.iinfo(kind).max
    # Rows are padded to multiples of four bytes, as the extension demands.
    padded = np.pad((SQUARE * top).astype(kind), ((0, 0), (0, 1)))
    view = made.add_view(padded.tobytes(), byteStride=4 * padded.itemsize)
    stated = describe(padded) | {"type": "VEC3", "normalized": normalised}
    attributes["POSITION"] = made.add("accessors", bufferView=view, **stated)
    whole = (SQUARE_UV * 100).astype(np.uint8)
    view = made.add_view(np.pad(whole, ((0, 0), (0, 2))).tobytes(), byteStride=4)
    attributes["TEXCOORD_0"] = made.add("accessors", bufferView=view, **describe(whole))
    base_texture(made)["extensions"] = {"KHR_texture_transform": {"scale": [0.01, 0.01]}}
    node = made.document["nodes"][0]
    node["scale"] = [1.0 if normalised else 1 / top] * 3
    mesh = read_mesh(made.write_glb(tmp_path / "a.glb"))
    assert np.allclose(mesh.vertices, SQUARE, atol=1e-12)
    assert np.array_equal(look_everywhere(mesh), show(picture))


@pytest.mark.parametrize("dense", [True, False])
def test_sparse_accessors(tmp_path: Path, dense: bool) -> None:
    made = textured(checks())
    rows, values = np.array([1, 3], np.uint8), np.array([[2, 0, 0], [0, 3, 1]], np.float32)
    sparse = {
        "count": 2,
        "indices": {"bufferView": made.add_view(rows.tobytes()), "componentType": 5121},
        "values": {"bufferView": made.add_view(values.tobytes())},
    }
    number = primitive(made)["attributes"]["POSITION"]
    accessor = made.document["accessors"][number]
    accessor["sparse"] = sparse
    if not dense:
        del accessor["bufferView"]
    mesh = read_mesh(made.write_glb(tmp_path / "a.glb"))
    expected = SQUARE.copy() if dense else np.zeros((4, 3))
    expected[rows] = values
    found = mesh.vertices[mesh.triangles]
    assert np.array_equal(found, expected[SQUARE_TRIANGLES.reshape(-1, 3)])


def test_interleaved_attributes(tmp_path: Path) -> None:
    picture = checks()
    made = textured(picture)
    rows = np.concatenate([SQUARE, np.ones((4, 3), np.float32), SQUARE_UV], 1)
    view = made.add_view(rows.tobytes(), byteStride=32)
    attributes = primitive(made)["attributes"]
    for name, start, values in (("POSITION", 0, SQUARE), ("TEXCOORD_0", 24, SQUARE_UV)):
        attributes[name] = made.add(
            "accessors", bufferView=view, byteOffset=start, **describe(values)
        )
    mesh = read_mesh(made.write_glb(tmp_path / "a.glb"))
    assert np.array_equal(mesh.vertices, SQUARE)
    assert np.array_equal(look_everywhere(mesh), show(picture))


HALF = np.sqrt(0.5)
NODES = {
    "translation": ([{"translation": [1, 2, 3]}], lambda p: p + [1, 2, 3]),
    "scale": ([{"scale": [2, 3, 4]}], lambda p: p * [2, 3, 4]),
    "rotation": ([{"rotation": [0, 0, HALF, HALF]}], lambda p: p[:, [1, 0, 2]] * [-1, 1, 1]),
    "all": (
        [{"translation": [1, 0, 0], "rotation": [0, 0, HALF, HALF], "scale": [2, 1, 1]}],
        lambda p: (p * [2, 1, 1])[:, [1, 0, 2]] * [-1, 1, 1] + [1, 0, 0],
    ),
    "matrix": (
        [{"matrix": [0, 2, 0, 0, -2, 0, 0, 0, 0, 0, 2, 0, 5, 6, 7, 1]}],
        lambda p: 2 * p[:, [1, 0, 2]] * [-1, 1, 1] + [5, 6, 7],
    ),
    "nested": (
        [{"scale": [2, 2, 2]}, {"translation": [1, 0, 0]}, {"rotation": [HALF, 0, 0, HALF]}],
        lambda p: 2 * (p[:, [0, 2, 1]] * [1, -1, 1] + [1, 0, 0]),
    ),
    "mirrored": ([{"scale": [-1, 1, 1]}], lambda p: p * [-1, 1, 1]),
    "mirrored twice": ([{"scale": [-1, 1, 1]}, {"scale": [1, -2, 1]}], lambda p: p * [-1, -2, 1]),
}


@pytest.mark.parametrize("name", NODES)
def test_nodes_place_meshes_and_keep_their_front(tmp_path: Path, name: str) -> None:
    chain, place = NODES[name]
    made = textured(checks())
    mesh = made.document["nodes"].pop()
    for number, node in enumerate(chain):
        last = number == len(chain) - 1
        made.document["nodes"].append({**node, **(mesh if last else {"children": [number + 1]})})
    path = made.write_glb(tmp_path / "a.glb")
    found = read_mesh(path)
    placed = place(SQUARE.astype(np.float64))
    assert np.allclose(found.vertices[np.unique(found.triangles)], placed, atol=1e-7)
    order = np.argsort(found.triangles[:, 1])
    normal = np.cross(*(np.diff(found.vertices[found.triangles[order[0]]], axis=0)))
    flat = found.triangles.tolist()
    mirrored = name == "mirrored"
    assert (flat[0] == [2, 1, 0]) == mirrored
    # trimesh's own reading agrees.
    other = trimesh.load_mesh(path, process=False)
    assert np.allclose(other.triangles_center.mean(0), found.vertices[found.triangles].mean((0, 1)))
    assert np.dot(normal, other.face_normals[0]) > 0


@pytest.mark.parametrize(
    ("mode", "indices", "triangles"),
    [
        (4, [0, 1, 2, 0, 2, 3], [[0, 1, 2], [0, 2, 3]]),
        (5, [0, 1, 3, 2], [[0, 1, 3], [1, 2, 3]]),
        (5, [0, 1, 3, 3, 1, 1, 1, 2, 3], [[0, 1, 3], [1, 2, 3]]),
        (6, [0, 1, 2, 3], [[1, 2, 0], [2, 3, 0]]),
    ],
)
@pytest.mark.parametrize("indexed", [True, False])
def test_strips_and_fans(
    tmp_path: Path, mode: int, indices: list[int], triangles: list[list[int]], indexed: bool
) -> None:
    made = GltfBuilder()
    one = made.add_square(mode=mode)
    if indexed:
        one["indices"] = made.add_array(np.array(indices, np.uint32))
    else:
        del one["indices"]
        one["attributes"] = {"POSITION": made.add_array(SQUARE[indices])}
    mesh = read_mesh(made.write_glb(tmp_path / "a.glb"))
    corners = mesh.vertices[mesh.triangles]
    area = np.linalg.norm(np.cross(*np.diff(corners, axis=1).transpose(1, 0, 2)), axis=1)
    assert np.array_equal(corners[area > 0], SQUARE[np.array(triangles)])


@pytest.mark.parametrize("mode", [0, 1, 2, 3])
def test_points_and_lines_are_no_faces(tmp_path: Path, mode: int) -> None:
    picture = checks()
    made = textured(picture)
    material = primitive(made)["material"]
    made.add_square(material, mode=mode)
    path = made.write_glb(tmp_path / "a.glb")
    assert len(read_mesh(path).triangles) == 2
    primitive(made)["mode"] = mode
    with pytest.raises(InputError, match=r"a\.glb has no faces, only 8 points"):
        read_mesh(made.write_glb(path))


def test_several_primitives_and_materials(tmp_path: Path) -> None:
    left, right = checks(), checks(2, 2, seed=1, side=24)
    made = textured(left)
    second = made.add_material(made.add_picture(encode(right, "JPEG", quality=100, subsampling=0)))
    attributes = {"POSITION": made.add_array(SQUARE + np.float32([1, 0, 0]))}
    attributes["TEXCOORD_0"] = made.add_array(SQUARE_UV)
    indices = made.add_array(SQUARE_TRIANGLES.astype(np.uint8))
    made.document["meshes"][0]["primitives"].append(
        {"attributes": attributes, "indices": indices, "material": second}
    )
    third = made.add("materials", pbrMetallicRoughness={"baseColorFactor": [0.5, 0.1, 0.2, 1]})
    made.add_square(third)
    made.document["nodes"][-1]["translation"] = [2, 0, 0]
    mesh = read_mesh(made.write_glb(tmp_path / "a.glb"))
    assert np.array_equal(look_everywhere(mesh), show(left))
    shifted = Mesh(
        mesh.vertices - [1, 0, 0], mesh.triangles, mesh.uv, mesh.uv_triangles, mesh.texture
    )
    assert np.abs(look_everywhere(shifted) - show(right)).max() < 6
    plain = multiply(np.full(3, 255), [0.5, 0.1, 0.2])
    assert np.abs(look(mesh, 2.5, 0.5) - plain).max() <= 1


def test_the_default_scene_is_read(tmp_path: Path) -> None:
    made = textured(checks())
    made.add_square()
    made.document["scenes"] = [{"nodes": [1], "name": "props"}, {"nodes": [0], "name": "head"}]
    made.document["scene"] = 1
    mesh = read_mesh(made.write_glb(tmp_path / "a.glb"))
    assert len(mesh.triangles) == 2 and mesh.texture is not None
    assert "has 2 scenes; head is read" in mesh.notes[0]
    del made.document["scene"]
    mesh = read_mesh(made.write_glb(tmp_path / "a.glb"))
    assert "states none; props is read" in mesh.notes[0]
    del made.document["scenes"]
    assert len(read_mesh(made.write_glb(tmp_path / "a.glb")).triangles) == 4


NAMES = {
    "plain": ("skin.png", "skin.png"),
    "percent": ("my%20skin%C3%A9.png", "my skiné.png"),
    "percent twice": ("100%25.png", "100%.png"),
    "not encoded": ("my skin é.png", "my skin é.png"),
    "literal percent": ("a%20b.png", "a%20b.png"),
    "back-slash": ("textures\\skin.png", "textures/skin.png"),
    "encoded back-slash": ("textures%5Cskin.png", "textures/skin.png"),
    "dot": ("./textures/skin.png", "textures/skin.png"),
    "case": ("Textures/SKIN.PNG", "textures/Skin.png"),
    "decomposed": ("skine\u0301.png", "skin\u00e9.png"),
    "query": ("skin.png?v=2", "skin.png"),
}


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("kind", ["picture", "buffer"])
def test_files_are_found_as_they_are_named(tmp_path: Path, name: str, kind: str) -> None:
    uri, file = NAMES[name]
    picture = checks()
    made = textured(picture)
    # Other pictures of the folder are never taken in its place.
    Image.new("RGB", (8, 8), (1, 2, 3)).save(tmp_path / "a.png")
    if kind == "picture":
        made.document["images"] = [{"uri": uri}]
        (tmp_path / file).parent.mkdir(exist_ok=True)
        (tmp_path / file).write_bytes(encode(picture))
        path = made.write_gltf(tmp_path / "a.gltf")
    else:
        path = made.write_gltf(tmp_path / "a.gltf", uri, file)
    assert np.array_equal(look_everywhere(read_mesh(path)), show(picture))
    (tmp_path / file).unlink()
    with pytest.raises(InputError, match=r"a\.gltf names the " + kind) as error:
        read_mesh(path)
    assert repr(uri) in str(error.value)


@pytest.mark.parametrize(
    "uri", ["C:\\scans\\skin.png", "file:///C:/scans/skin.png", "/home/a/skin.png", "maps/Skin.png"]
)
def test_files_of_another_machine_are_found_by_their_names_and_said(
    tmp_path: Path, uri: str
) -> None:
    picture = checks()
    made = textured(picture)
    made.document["images"] = [{"uri": uri}]
    path = made.write_gltf(tmp_path / "a.gltf")
    (tmp_path / "other.png").write_bytes(encode(checks(seed=1)))
    with pytest.raises(InputError, match=r"names the picture .*--texture"):
        read_mesh(path)
    (tmp_path / "skin.png").write_bytes(encode(picture))
    mesh = read_mesh(path)
    assert np.array_equal(look_everywhere(mesh), show(picture))
    assert uri.split("/")[-1] in mesh.notes[0] or repr(uri) in mesh.notes[0]
    assert "skin.png is taken" in mesh.notes[0]


@pytest.mark.parametrize(
    "head", ["data:image/png;base64,", "data:;base64,", "data:image/png;charset=x;base64,", "plain"]
)
def test_pictures_in_data_uris(tmp_path: Path, head: str) -> None:
    picture = checks()
    made = textured(picture)
    data = encode(picture)
    body = quote(data) if head == "plain" else base64.b64encode(data).decode().rstrip("=")
    uri = "data:image/png," + body if head == "plain" else head + body
    made.document["images"] = [{"uri": uri}]
    assert np.array_equal(
        look_everywhere(read_mesh(made.write_glb(tmp_path / "a.glb"))), show(picture)
    )


@pytest.mark.parametrize(
    ("extension", "kind"), [("EXT_texture_webp", "WEBP"), ("EXT_texture_avif", "AVIF")]
)
@pytest.mark.parametrize("fallback", [True, False])
def test_pictures_of_newer_formats(
    tmp_path: Path, extension: str, kind: str, fallback: bool
) -> None:
    picture = checks()
    made = textured(picture)
    options = {"lossless": True} if kind == "WEBP" else {"quality": 100, "subsampling": "4:4:4"}
    view = made.add_view(encode(picture, kind, **options))
    number = made.add("images", bufferView=view, mimeType=f"image/{kind.lower()}")
    texture = made.document["textures"][0]
    texture["extensions"] = {extension: {"source": number}}
    if not fallback:
        del texture["source"]
        made.require(extension)
    seen = look_everywhere(read_mesh(made.write_glb(tmp_path / "a.glb")))
    assert np.abs(seen - show(picture)).max() <= 3


@pytest.mark.parametrize("extension", ["KHR_texture_basisu", "MSFT_texture_dds"])
def test_compressed_pictures_are_refused_by_name_unless_there_is_another(
    tmp_path: Path, extension: str
) -> None:
    picture = checks()
    made = textured(picture)
    ktx = made.add("images", bufferView=made.add_view(b"\xabKTX 20\xbb\r\n\x1a\n" + bytes(60)))
    texture = made.document["textures"][0]
    texture["extensions"] = {extension: {"source": ktx}}
    path = made.write_glb(tmp_path / "a.glb")
    assert np.array_equal(look_everywhere(read_mesh(path)), show(picture))
    del texture["source"]
    made.require(extension)
    with pytest.raises(InputError, match=rf"a\.glb .*{extension}, .*PNG or JPEG"):
        read_mesh(made.write_glb(path))
    # The picture that the user gives is enough.
    (tmp_path / "given.png").write_bytes(encode(picture))
    assert np.array_equal(look_everywhere(read_mesh(path, tmp_path / "given.png")), show(picture))
    del texture["extensions"]
    texture["source"] = ktx
    with pytest.raises(InputError, match="KTX2"):
        read_mesh(made.write_glb(path))


@pytest.mark.parametrize("mode", ["OPAQUE", None, "MASK", "BLEND"])
def test_alpha_counts_where_the_material_says_so(tmp_path: Path, mode: str | None) -> None:
    picture = checks()
    alpha = checks(seed=5)[..., :1]
    made = GltfBuilder()
    made.add_square(
        made.add_material(made.add_picture(encode(np.concatenate([picture, alpha], -1))))
    )
    if mode is not None:
        made.document["materials"][0]["alphaMode"] = mode
    seen = look_everywhere(read_mesh(made.write_glb(tmp_path / "a.glb")))
    share = show(alpha.repeat(3, -1)) / 255
    share = {"MASK": (share >= 0.5).astype(float), "BLEND": share}.get(mode or "", np.ones(()))
    assert np.abs(seen - (show(picture) * share + 255 * (1 - share))).max() <= 1


@pytest.mark.parametrize("beside", [True, False])
@pytest.mark.parametrize(
    "role", ["normalTexture", "occlusionTexture", "emissiveTexture", "metallicRoughnessTexture"]
)
def test_other_pictures_never_become_skin(tmp_path: Path, role: str, beside: bool) -> None:
    made = textured(checks())
    material = made.document["materials"][0]
    texture = material["pbrMetallicRoughness"].pop("baseColorTexture")
    (material["pbrMetallicRoughness"] if "metallic" in role else material)[role] = texture
    if beside:
        made.document["images"] = [{"uri": "a.png"}]
        (tmp_path / "a.png").write_bytes(encode(checks()))
    mesh = read_mesh(made.write_glb(tmp_path / "a.glb"))
    assert mesh.texture is None
    assert f"skin has a picture as {role}, and none for its base colour" in mesh.notes[0]


@pytest.mark.parametrize(
    "name",
    [
        "KHR_materials_unlit",
        "KHR_materials_clearcoat",
        "KHR_materials_ior",
        "KHR_lights_punctual",
        "KHR_materials_variants",
    ],
)
def test_required_extensions_that_change_no_colour_are_read(tmp_path: Path, name: str) -> None:
    picture = checks()
    made = textured(picture)
    made.document["materials"][0]["extensions"] = {name: {}}
    made.require(name)
    assert np.array_equal(
        look_everywhere(read_mesh(made.write_glb(tmp_path / "a.glb"))), show(picture)
    )


@pytest.mark.parametrize(
    "name", ["EXT_mesh_gpu_instancing", "KHR_gaussian_splatting", "CESIUM_RTC", "ACME_anything"]
)
def test_other_required_extensions_are_refused_by_name(tmp_path: Path, name: str) -> None:
    made = textured(checks())
    made.document["extensionsUsed"] = [name]
    path = made.write_glb(tmp_path / "a.glb")
    assert read_mesh(path).texture is not None
    made.document["extensionsRequired"] = [name]
    with pytest.raises(InputError, match=rf"a\.glb requires the glTF extension {name}, .*export"):
        read_mesh(made.write_glb(path))


@pytest.mark.parametrize("required", [True, False])
def test_draco_is_refused_by_name_unless_the_mesh_is_there_plain(
    tmp_path: Path, required: bool
) -> None:
    made = textured(checks())
    name = "KHR_draco_mesh_compression"
    view = made.add_view(b"DRACO\x02\x02" + bytes(20))
    primitive(made)["extensions"] = {name: {"bufferView": view, "attributes": {"POSITION": 0}}}
    if required:
        made.require(name)
    path = made.write_glb(tmp_path / "a.glb")
    assert read_mesh(path).texture is not None
    for accessor in made.document["accessors"]:
        del accessor["bufferView"]
    with pytest.raises(
        InputError, match=rf"a\.glb has compressed meshes \({name}\).*gltf-transform"
    ):
        read_mesh(made.write_glb(path))


@pytest.mark.parametrize("name", ["EXT_meshopt_compression", "KHR_meshopt_compression"])
def test_meshopt_is_refused_by_name_unless_the_mesh_is_there_plain(
    tmp_path: Path, name: str
) -> None:
    made = textured(checks())
    view = made.document["bufferViews"][primitive(made)["attributes"]["POSITION"]]
    packed = {"buffer": 0, "byteLength": 8, "byteStride": 12, "count": 4, "mode": "ATTRIBUTES"}
    view["extensions"] = {name: packed}
    path = made.write_glb(tmp_path / "a.glb")
    assert read_mesh(path).texture is not None
    made.require(name)
    made.document["buffers"] = [{}, {"byteLength": 999, "extensions": {name: {"fallback": True}}}]
    view["buffer"] = 1
    with pytest.raises(InputError, match=rf"a\.glb has compressed meshes \({name}\).*gltfpack"):
        read_mesh(made.write_glb(path))


def skinned(scale: float) -> GltfBuilder:
    """A square bound to two joints, the second of which is turned up by its node."""
    made = textured(checks())
    inverse = np.stack([np.eye(4), np.eye(4)]).astype(np.float32)
    inverse[1, 3, 0] = -1  # column-major: the second joint was bound at x = 1
    joints = np.array([[0, 1, 0, 0]] * 4, np.uint8)
    weights = np.array([[1, 0, 0, 0], [0.25, 0.75, 0, 0], [0, 1, 0, 0], [1, 0, 0, 0]], np.float32)
    attributes = primitive(made)["attributes"]
    attributes["JOINTS_0"] = made.add_array(joints)
    attributes["WEIGHTS_0"] = made.add_array(weights)
    nodes = made.document["nodes"]
    nodes[0].update(skin=0, translation=[9, 9, 9])
    nodes.append({"scale": [scale] * 3, "children": [2, 3]})
    nodes.append({})
    nodes.append({"translation": [1, 0, 5]})
    made.document["scenes"][0]["nodes"].append(1)
    matrices = made.add_array(inverse.reshape(2, 16))
    made.add("skins", joints=[2, 3], inverseBindMatrices=matrices)
    return made


@pytest.mark.parametrize("scale", [1.0, 0.01])
def test_skins_are_posed_as_the_nodes_state(tmp_path: Path, scale: float) -> None:
    made = skinned(scale)
    made.add("animations", channels=[], samplers=[])
    mesh = read_mesh(made.write_glb(tmp_path / "a.glb"))
    expected = SQUARE + np.array([0, 3.75, 5, 0])[:, None] * [0, 0, 1]
    assert np.allclose(mesh.vertices, scale * expected)
    assert "left at rest" in mesh.notes[0]


@pytest.mark.parametrize("at", ["mesh", "node", "both", "nowhere"])
def test_morph_targets_have_the_weights_that_the_file_states(tmp_path: Path, at: str) -> None:
    made = textured(checks())
    moved = np.zeros((4, 3), np.float32)
    moved[2] = [0, 0, 4]
    primitive(made)["targets"] = [{"POSITION": made.add_array(moved)}]
    if at in ("mesh", "both"):
        made.document["meshes"][0]["weights"] = [0.5]
    if at in ("node", "both"):
        made.document["nodes"][0]["weights"] = [0.25]
    mesh = read_mesh(made.write_glb(tmp_path / "a.glb"))
    weight = {"mesh": 0.5, "node": 0.25, "both": 0.25, "nowhere": 0}[at]
    assert np.array_equal(mesh.vertices, SQUARE + weight * moved)


def break_glb(change: Callable[[bytearray], Any]) -> Callable[[Path], Path]:
    def write(folder: Path) -> Path:
        path = textured(checks()).write_glb(folder / "a.glb")
        data = bytearray(path.read_bytes())
        path.write_bytes(change(data) or data)
        return path

    return write


def break_document(change: Callable[[GltfBuilder], Any]) -> Callable[[Path], Path]:
    def write(folder: Path) -> Path:
        made = textured(checks())
        change(made)
        return made.write_glb(folder / "a.glb")

    return write


def write_text(text: str) -> Callable[[Path], Path]:
    def write(folder: Path) -> Path:
        (folder / "a.gltf").write_text(text)
        return folder / "a.gltf"

    return write


BROKEN = {
    "cut": (break_glb(lambda data: data[:-100]), r"of the [\d,]+ bytes that its header states"),
    "cut in the header": (break_glb(lambda data: data[:10]), "less than the header"),
    "version 1": (break_glb(lambda data: struct.pack_into("<I", data, 4, 1)), "is glTF 1, .*2.0"),
    "asset 1.0": (
        break_document(lambda made: made.document.update(asset={"version": "1.0"})),
        "is glTF 1.0, and only glTF 2.0 is read; convert it",
    ),
    "objects of glTF 1.0": (write_text('{"meshes": {"a": {}}, "nodes": {}}'), "is glTF 1.0"),
    "version 3": (
        break_document(lambda made: made.document.update(asset={"version": "3.0"})),
        "is glTF 3.0",
    ),
    "minVersion": (
        break_document(lambda m: m.document.update(asset={"version": "2.1", "minVersion": "2.1"})),
        "is glTF 2.1",
    ),
    "empty": (write_text(""), "is empty"),
    "cut text": (write_text('{"asset": {"version": "2.0"}, "mesh'), "broken"),
    "a page": (write_text("<!DOCTYPE html><html>"), "DOCTYPE"),
    "a list": (write_text("[1, 2]"), "not an object"),
    "no meshes": (write_text('{"asset": {"version": "2.0"}}'), "has no faces, only 0 points"),
    "an accessor beyond its view": (
        break_document(lambda made: made.document["accessors"][0].update(count=5)),
        "do not fit",
    ),
    "a view beyond its buffer": (
        break_document(lambda made: made.document["bufferViews"][0].update(byteLength=1 << 30)),
        "ends at byte",
    ),
    "a material that is not there": (
        break_document(lambda made: primitive(made).update(material=7)),
        "refers to number 7",
    ),
    "a vertex that is not there": (
        break_document(
            lambda made: primitive(made).update(indices=made.add_array(np.uint16([0, 1, 65535])))
        ),
        "has a face with vertex 65535, and 4 vertices",
    ),
    "too few coordinates": (
        break_document(
            lambda m: primitive(m)["attributes"].update(TEXCOORD_0=m.add_array(SQUARE_UV[:3]))
        ),
        "3 rows for 4 vertices",
    ),
    "no coordinates": (
        break_document(lambda made: primitive(made)["attributes"].pop("TEXCOORD_0")),
        "skin has its texture at TEXCOORD_0, which a mesh does not have",
    ),
    "a texCoord that is not there": (
        break_document(lambda made: base_texture(made).update(texCoord=1)),
        "skin has its texture at TEXCOORD_1",
    ),
    "nodes in a circle": (
        break_document(lambda made: made.document["nodes"][0].update(children=[0])),
        "its own ancestor",
    ),
    "not a picture": (
        break_document(lambda made: made.document["images"][0].update(bufferView=1)),
        "picture inside of .* not a picture",
    ),
    "a web address": (
        break_document(
            lambda made: made.document.update(images=[{"uri": "https://a.example/skin.png"}])
        ),
        "by the address https://a.example/skin.png; download it",
    ),
    "a buffer of another length": (
        break_document(lambda m: m.document["bufferViews"][0].update(buffer=3)),
        "refers to number 3",
    ),
    "words for numbers": (
        break_document(lambda made: made.document["nodes"][0].update(translation="far")),
        "cannot be read as a mesh",
    ),
}


@pytest.mark.parametrize("name", BROKEN)
def test_broken_files_are_refused_in_a_sentence(tmp_path: Path, name: str) -> None:
    write, message = BROKEN[name]
    path = write(tmp_path)
    with pytest.raises(InputError, match=message) as error:
        read_mesh(path)
    assert path.name in str(error.value) and str(error.value).endswith((".", "?"))


def test_no_cut_of_a_file_is_read(tmp_path: Path) -> None:
    data = textured(checks()).write_glb(tmp_path / "a.glb").read_bytes()
    for length in range(0, len(data), max(len(data) // 40, 1)):
        (tmp_path / "a.glb").write_bytes(data[:length])
        with pytest.raises(InputError, match=r"a\.glb"):
            read_mesh(tmp_path / "a.glb")


@pytest.mark.parametrize("suffix", [".glb", ".gltf"])
def test_a_file_that_trimesh_writes_is_read_alike(tmp_path: Path, suffix: str) -> None:
    ball = trimesh.creation.uv_sphere(count=[6, 8])
    uv = np.stack([ball.vertices[:, 0] / 2 + 0.5, ball.vertices[:, 2] / 2 + 0.5], 1)
    image = Image.fromarray(checks())
    material = trimesh.visual.material.PBRMaterial(baseColorTexture=image)
    ball.visual = trimesh.visual.TextureVisuals(uv, material)
    scene = trimesh.Scene()
    turn = trimesh.transformations.rotation_matrix(0.7, [1, 2, 3], [0.1, 0, 0])
    scene.add_geometry(ball, transform=turn)
    if suffix == ".glb":
        scene.export(tmp_path / "a.glb")
    else:
        for name, data in trimesh.exchange.gltf.export_gltf(scene).items():
            (tmp_path / name.replace("model.gltf", "a.gltf")).write_bytes(data)
    mesh = read_mesh(tmp_path / f"a{suffix}")
    other = trimesh.load_mesh(tmp_path / f"a{suffix}", process=False)
    assert np.allclose(mesh.vertices[mesh.triangles], other.triangles, atol=1e-7)
    assert np.allclose(mesh.uv[mesh.uv_triangles], other.visual.uv[other.faces], atol=1e-7)
    assert np.array_equal(mesh.texture, checks())


def test_a_profile_in_a_picture_is_read_and_said(tmp_path: Path) -> None:
    picture = checks()
    linear = colour.RGB_to_RGB(decode(picture), "sRGB", "Display P3")
    stored = np.rint(255 * colour.models.eotf_inverse_sRGB(linear.clip(0, 1))).astype(np.uint8)
    file = io.BytesIO()
    Image.fromarray(stored).save(file, "PNG", icc_profile=DISPLAY_P3.profile())
    made = GltfBuilder()
    made.add_square(made.add_material(made.add_picture(file.getvalue())))
    mesh = read_mesh(made.write_glb(tmp_path / "a.glb"))
    assert np.abs(look_everywhere(mesh) - show(picture)).max() <= 2
    assert "ICC profile" in mesh.notes[0] and "viewers of glTF take it as sRGB" in mesh.notes[0]


def test_the_command_refuses_in_a_sentence(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    made = textured(checks())
    made.require("ACME_anything")
    path = made.write_glb(tmp_path / "a.glb")
    assert main(["maps", str(path), "-o", str(tmp_path / "maps")]) == 2
    assert "requires the glTF extension ACME_anything" in capsys.readouterr().err
