"""The atlas: every triangle keeps its texels, whatever is placed beside them."""

import numpy as np

from skinnet.mesh._mesh_parts import MeshGeometry, MeshPart
from skinnet.mesh._sampling import sample_bilinear
from skinnet.mesh._texture_atlas import pack_atlas, wrap_coordinates

CORNERS = np.array([[0.0, 0], [1, 0], [1, 1]])
RED, BLUE = np.array([255, 0, 0], np.uint8), np.array([0, 0, 255], np.uint8)


def part(uv: np.ndarray | None, texture: np.ndarray | None, colour: np.ndarray = RED) -> MeshPart:
    geometry = MeshGeometry(np.zeros((3, 3)), np.array([[0, 1, 2]]))
    return MeshPart(geometry, uv, texture, colour)


def noise(height: int, width: int, seed: int = 0) -> np.ndarray:
    return np.random.default_rng(seed).integers(0, 256, (height, width, 3), np.uint8)


def test_parts_without_pictures_keep_their_coordinates() -> None:
    atlas = pack_atlas([part(CORNERS, None), part(CORNERS / 2, None)])
    assert atlas is not None and atlas.texture is None
    assert np.array_equal(atlas.uv[atlas.triangles], [CORNERS, CORNERS / 2])


def test_a_part_without_coordinates_and_no_picture_make_no_atlas() -> None:
    assert pack_atlas([part(CORNERS, None), part(None, None)]) is None


def test_one_picture_for_all_stays_as_it_is() -> None:
    texture = noise(8, 6)
    atlas = pack_atlas([part(CORNERS, texture), part(CORNERS + 3, texture.copy())])
    assert atlas is not None and np.array_equal(atlas.texture, texture)
    assert np.array_equal(atlas.uv[atlas.triangles], [CORNERS, CORNERS + 3])


def test_different_pictures_stand_side_by_side() -> None:
    textures = [noise(8, 6), noise(5, 4, 1), noise(8, 6)]
    parts = [part(CORNERS * 0.8 + 0.1, texture) for texture in textures]
    atlas = pack_atlas(parts)
    assert atlas is not None and atlas.texture is not None
    # The third picture equals the first and is not repeated.
    assert atlas.texture.shape == (8, 10, 3)
    for triangle, each in zip(atlas.triangles, parts, strict=True):
        assert each.uv is not None and each.texture is not None
        middle = atlas.uv[triangle].mean(0, keepdims=True), each.uv.mean(0, keepdims=True)
        found = sample_bilinear(atlas.texture, middle[0])
        assert np.allclose(found, sample_bilinear(each.texture, middle[1]), atol=1e-3)


def test_a_part_without_a_picture_has_a_patch_of_its_colour() -> None:
    atlas = pack_atlas([part(CORNERS, noise(8, 6)), part(None, None, BLUE)])
    assert atlas is not None and atlas.texture is not None
    place = atlas.uv[atlas.triangles[1]]
    assert np.array_equal(sample_bilinear(atlas.texture, place), np.tile(BLUE, (3, 1)))


def test_coordinates_outside_are_wrapped_by_whole_tiles() -> None:
    uv = np.concatenate([CORNERS, CORNERS + [2, -1], CORNERS * 0.5 + [0.8, 0]])
    wrapped, triangles = wrap_coordinates(uv, np.arange(9).reshape(3, 3))
    corners = wrapped[triangles]
    assert np.array_equal(corners[0], CORNERS) and np.array_equal(corners[1], CORNERS)
    # The third lies across the border: its tile is that of its middle, and the rest is clipped.
    assert np.allclose(corners[2], [[0, 0], [0.3, 0], [0.3, 0.5]])
