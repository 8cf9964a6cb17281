"""Edges, boundaries and components of meshes that can be counted by hand."""

import numpy as np
import pytest
from small_meshes import COLUMNS, ROWS, dome
from trimesh.creation import icosphere

from skinnet.errors import InputError
from skinnet.mesh._topology import (
    compute_edge_keys,
    find_boundary_edges,
    label_components,
    list_boundary_loops,
    list_half_edges,
    weld,
)

SQUARE = np.array([[0, 1, 2], [0, 2, 3]])


def test_half_edges_go_around_each_triangle() -> None:
    assert list_half_edges(SQUARE[:1]).tolist() == [[0, 1], [1, 2], [2, 0]]


def test_keys_are_those_of_the_edge_in_either_direction_unless_directed() -> None:
    edges = np.array([[0, 1], [1, 0], [0, 2]])
    one, other, third = compute_edge_keys(edges, 4)
    assert one == other != third
    assert len(set(compute_edge_keys(edges, 4, directed=True).tolist())) == 3


def test_the_boundary_is_what_belongs_to_one_triangle() -> None:
    assert find_boundary_edges(SQUARE).tolist() == [[True, True, False], [False, True, True]]
    assert not find_boundary_edges(np.array(icosphere(subdivisions=1).faces)).any()


def test_boundary_loops_run_along_the_triangles() -> None:
    (loop,) = list_boundary_loops(SQUARE)
    assert np.roll(loop, -int(loop.argmin())).tolist() == [0, 1, 2, 3]
    (loop,) = list_boundary_loops(dome().triangles)
    assert len(loop) == 2 * (ROWS + COLUMNS - 2)


def test_a_hole_is_a_loop_of_its_own() -> None:
    triangles = dome().triangles
    middle = ROWS // 2 * COLUMNS + COLUMNS // 2
    loops = list_boundary_loops(triangles[(triangles != middle).all(1)])
    assert sorted(map(len, loops)) == [6, 2 * (ROWS + COLUMNS - 2)]


@pytest.mark.parametrize(
    ("triangles", "fault"),
    [
        ([[0, 1, 2], [0, 1, 3]], "edge of vertices 0 and 1 belongs to more than two"),
        ([[0, 1, 2], [0, 3, 4]], "boundaries of the mesh touch in vertex 0"),
    ],
)
def test_what_is_no_manifold_is_refused(triangles: list[list[int]], fault: str) -> None:
    with pytest.raises(InputError, match=fault):
        list_boundary_loops(np.array(triangles))


def test_components_are_vertices_that_triangles_connect() -> None:
    label = label_components(np.array([[0, 1, 2], [2, 3, 4], [5, 6, 7]]), 9)
    assert len(set(label[:5])) == len(set(label[5:8])) == 1
    assert len(set(label.tolist())) == 3


def test_weld_gives_the_first_vertex_at_each_position() -> None:
    vertices = np.array([[1, 0, 0], [0, 0, 0], [1, 0, 0], [-0.0, 0, 0], [1, 0, 1e-12]])
    assert weld(vertices).tolist() == [0, 1, 0, 1, 4]
    assert weld(np.zeros((0, 3))).tolist() == []
