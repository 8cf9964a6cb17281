"""The warp: exact for affine maps, equal to scikit-image's, averaged where the source is denser."""

import numpy as np
import pytest
from scipy.spatial import Delaunay

from benchmarks.texture import compare_with_skimage
from skinnet.errors import InputError
from skinnet.texture.warp import TextureSpace, warp_texture

SQUARE = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
HALVES = np.array([[0, 1, 2], [0, 2, 3]])


def scattered_space(size: int = 64) -> TextureSpace:
    inner = np.random.default_rng(0).uniform(0, 1, (20, 2))
    points = np.concatenate([SQUARE, inner])
    return TextureSpace(points, Delaunay(points).simplices.astype(np.int64), size)


def everywhere(space: TextureSpace) -> np.ndarray:
    return np.ones(len(space.triangles), bool)


def test_a_picture_warped_onto_itself_is_itself() -> None:
    space = TextureSpace(SQUARE, HALVES, 32)
    picture = np.random.default_rng(0).random((32, 32, 3))
    image, mask = warp_texture(space, SQUARE[HALVES], everywhere(space), picture)
    assert mask.all() and np.allclose(image, picture, atol=1e-6)


def test_a_linear_picture_follows_an_affine_map_exactly() -> None:
    space = scattered_space()
    matrix, shift = np.array([[0.5, 0.2], [-0.1, 0.6]]), np.array([0.15, 0.15])
    coordinates = space.uv @ matrix + shift
    row, column = np.mgrid[:50, :80]
    picture = np.stack([column, row], -1).astype(np.float32)
    image, mask = warp_texture(space, coordinates[space.triangles], everywhere(space), picture)
    centre = (np.arange(64) + 0.5) / 64
    u, v = np.meshgrid(centre, centre[::-1])
    place = np.stack([u, v], -1) @ matrix + shift
    expected = np.stack([place[..., 0] * 80 - 0.5, (1 - place[..., 1]) * 50 - 0.5], -1)
    assert np.allclose(image[mask], expected[mask], atol=1e-4)


def test_warp_equals_scikit_image_inside_the_mesh() -> None:
    found = compare_with_skimage(points=40, size=96)
    assert found["warp_vs_skimage_max_difference"] < 1e-5


def test_triangles_that_are_not_covered_stay_masked() -> None:
    space = TextureSpace(SQUARE, HALVES, 16)
    picture = np.ones((4, 4, 2), np.float32)
    covered = np.array([True, False])
    image, mask = warp_texture(space, SQUARE[HALVES], covered, picture)
    assert np.array_equal(mask, space.triangle == 0) and 0 < mask.sum() < mask.size
    assert (image[~mask] == 0).all() and (image[mask] == 1).all()


def test_a_denser_source_is_averaged_over_a_texel() -> None:
    space = TextureSpace(SQUARE, HALVES, 16)
    fine = np.random.default_rng(0).random((64, 64, 1))
    image, _ = warp_texture(space, SQUARE[HALVES], everywhere(space), fine)
    boxes = fine.reshape(16, 4, 16, 4, 1).mean((1, 3))
    # k samples of a bilinear picture stand for the box of k pixels.
    assert np.abs(image - boxes).max() < 1e-6
    point, _ = warp_texture(space, SQUARE[HALVES], everywhere(space), fine, max_samples=1)
    assert np.abs(point - boxes).mean() > 0.05


def test_uint8_pictures_keep_their_scale() -> None:
    space = TextureSpace(SQUARE, HALVES, 8)
    picture = np.random.default_rng(0).integers(0, 256, (8, 8, 3), np.uint8)
    image, _ = warp_texture(space, SQUARE[HALVES], everywhere(space), picture)
    assert image.dtype == np.float32 and np.allclose(image, picture, atol=1e-3)


def test_values_of_vertices_and_corners_are_interpolated() -> None:
    space = scattered_space()
    image = space.interpolate(space.uv)
    centre = (np.arange(64) + 0.5) / 64
    expected = np.stack(np.meshgrid(centre, centre[::-1]), -1)
    assert np.allclose(image[space.mask], expected[space.mask], atol=1e-12)
    numbers = np.repeat(np.arange(len(space.triangles)), 3).reshape(-1, 3, 1).astype(np.float64)
    assert np.allclose(space.interpolate(numbers)[space.mask, 0], space.triangle[space.mask])


@pytest.mark.parametrize(
    ("triangles", "size", "sentence"),
    [
        (HALVES + 1, 8, "corners from 0 to 3"),
        (HALVES[:0], 8, "needs triangles"),
        (HALVES, 0, "got 0"),
    ],
)
def test_a_space_that_cannot_be_is_refused(triangles: np.ndarray, size: int, sentence: str) -> None:
    with pytest.raises(InputError, match=sentence):
        TextureSpace(SQUARE, triangles, size)
