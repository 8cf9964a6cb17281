"""Vertex colours: multiplied into a texture in linear light."""

import numpy as np

from skinnet.images import linear_to_srgb, to_uint8
from skinnet.mesh._gltf.vertex_colours import bake_colours

WHITE = np.full((24, 16, 3), 255, np.uint8)
# v points down.
LEFT = np.array([[[0, 0], [0, 1], [0.5, 1]], [[0, 0], [0.5, 1], [0.5, 0]]])


def test_colours_lie_where_their_triangles_do() -> None:
    colours = np.zeros((2, 3, 3)) + [0.2, 0.4, 0.6]
    colours[:, :, 0] = LEFT[..., 1]
    baked = bake_colours(WHITE, LEFT, colours)
    assert baked is not None and baked.shape == WHITE.shape
    rows = (np.arange(24) + 0.5) / 24
    expected = np.stack([rows, 0 * rows + 0.4, 0 * rows + 0.6], 1)
    # The right half has no triangle; it continues the left, for the edges' interpolation.
    assert np.abs(baked.astype(int) - to_uint8(linear_to_srgb(expected))[:, None]).max() <= 1


def test_texels_of_two_colours_are_found() -> None:
    colours = np.repeat([[[0.2, 0.4, 0.6]], [[0.8, 0.4, 0.6]]], 3, 1)
    assert bake_colours(WHITE, LEFT, colours) is not None
    assert bake_colours(WHITE, LEFT[[0, 0]], colours) is None
    assert bake_colours(WHITE, LEFT[[0, 0]], colours[[1, 1]]) is not None


def test_triangles_without_an_area_give_no_texture() -> None:
    assert bake_colours(WHITE, np.zeros((2, 3, 2)), np.ones((2, 3, 3))) is None
