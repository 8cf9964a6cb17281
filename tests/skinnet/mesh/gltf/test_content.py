"""Parts of glTF files, with and without what a caller needs."""

from pathlib import Path

import numpy as np
import pytest
from gltf_files import SQUARE, SQUARE_UV, GltfBuilder, checks, encode

from skinnet.errors import InputError
from skinnet.mesh._gltf.content import read_gltf


def build() -> GltfBuilder:
    made = GltfBuilder()
    made.add_square(made.add_material(made.add_picture(encode(checks()))))
    return made


def test_a_given_picture_replaces_one_that_is_missing(tmp_path: Path) -> None:
    made, given = build(), checks(seed=1)
    made.document["images"] = [{"uri": "none.png"}]
    made.document["materials"][0]["pbrMetallicRoughness"]["baseColorFactor"] = [0.5, 0.5, 0.5, 1]
    path = made.write_glb(tmp_path / "a.glb")
    with pytest.raises(InputError, match=r"none\.png"):
        read_gltf(path)
    (part,) = read_gltf(path, given).parts
    assert np.array_equal(part.texture, given)


def test_shape_alone_needs_no_pictures_and_keeps_the_rows_of_the_file(tmp_path: Path) -> None:
    made = build()
    made.document["images"] = [{"uri": "none.png"}]
    uv = made.add_array(SQUARE_UV * np.float32(3))
    made.document["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"] = uv
    content = read_gltf(made.write_glb(tmp_path / "a.glb"), textured=False)
    (part,) = content.parts
    assert np.array_equal(part.geometry.vertices, SQUARE) and part.texture is None
    assert np.allclose(part.uv, 3 * SQUARE_UV * [1, -1] + [0, 1])


def test_parts_without_coordinates_have_their_colour(tmp_path: Path) -> None:
    made = build()
    plain = made.add("materials", pbrMetallicRoughness={"baseColorFactor": [1, 0.2159, 0, 1]})
    one = made.add_square(plain)
    del one["attributes"]["TEXCOORD_0"]
    path = made.write_glb(tmp_path / "a.glb")
    for given in (None, checks(seed=1)):
        textured, bare = read_gltf(path, given).parts
        assert textured.uv is not None and bare.uv is None and bare.texture is None
        assert bare.colour.tolist() == [255, 128, 0]


def test_vertex_colours_without_coordinates_are_averaged_and_said(tmp_path: Path) -> None:
    made = GltfBuilder()
    one = made.add_square()
    del one["attributes"]["TEXCOORD_0"]
    colours = np.array([[1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 1]], np.float32)
    one["attributes"]["COLOR_0"] = made.add_array(colours)
    content = read_gltf(made.write_glb(tmp_path / "a.glb"))
    assert content.parts[0].colour.tolist() == [188, 188, 188] and content.names_pictures
    assert "vertex colours" in content.notes[0] and "averaged" in content.notes[0]


def test_parts_of_one_material_share_one_texture(tmp_path: Path) -> None:
    made = build()
    second = made.add_square(0)
    second["attributes"]["TEXCOORD_0"] = made.add_array(SQUARE_UV + np.float32([0.5, 0]))
    first, other = read_gltf(made.write_glb(tmp_path / "a.glb")).parts
    assert first.texture is other.texture
    assert first.texture is not None and first.texture.shape[1] > 64
