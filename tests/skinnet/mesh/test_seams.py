"""Seams: positions are merged in the order of the file, coordinates where they are equal."""

import numpy as np

from skinnet.mesh._mesh_parts import MeshGeometry
from skinnet.mesh._seams import match_positions, merge_coordinates, merge_vertices

LISTED = np.array([[9.0, 9, 9], [0, 1, 0], [1, 0, 0], [0, 0, 0]])
# trimesh repeats vertices along a seam, and sorts them by material.
GEOMETRY = MeshGeometry(
    np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 0, 0], [0, 0, 5]]),
    np.array([[0, 1, 2], [3, 4, 2]]),
)


def test_merged_vertices_are_in_the_order_of_the_file() -> None:
    merged = merge_vertices(GEOMETRY, LISTED)
    assert merged.vertices.tolist() == [[0, 1, 0], [1, 0, 0], [0, 0, 0], [0, 0, 5]]
    assert np.array_equal(merged.vertices[merged.triangles], GEOMETRY.vertices[GEOMETRY.triangles])


def test_without_a_list_the_order_is_that_of_the_geometry() -> None:
    merged = merge_vertices(GEOMETRY, np.zeros((0, 3)))
    assert merged.vertices.tolist() == [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 5]]
    assert merged.triangles.tolist() == [[0, 1, 2], [1, 3, 2]]


def test_positions_are_matched_to_the_first_of_the_list() -> None:
    repeated = np.concatenate([LISTED, LISTED])
    assert match_positions(repeated, GEOMETRY.vertices)[:4].tolist() == [3, 2, 1, 2]
    assert match_positions(repeated, GEOMETRY.vertices)[4] >= len(repeated)


def test_coordinates_are_merged_only_at_the_same_vertex() -> None:
    triangles = np.array([[0, 1, 2], [0, 2, 3]])
    uv = np.array([[0.0, 0], [1, 0], [1, 1], [0.5, 0.5], [1, 1], [1, 0]])
    merged, merged_triangles = merge_coordinates(triangles, uv, np.arange(6).reshape(2, 3))
    assert np.array_equal(merged[merged_triangles], uv.reshape(2, 3, 2))
    assert len(merged) == 5
    # Corner 2 is shared; corner 0 differs, and (1, 0) belongs to two vertices.
    assert merged_triangles[0, 2] == merged_triangles[1, 1]
