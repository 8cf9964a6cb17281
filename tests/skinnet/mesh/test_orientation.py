"""Orientation: disagreeing faces are found, a strip that has no orientation is left alone."""

import numpy as np
import pytest
from small_meshes import dome, moebius_strip
from trimesh.creation import icosphere

from skinnet.mesh._orientation import (
    compute_area_vectors,
    compute_areas,
    find_inconsistent_faces,
    flip_triangles,
    is_inside_out,
    label_face_components,
    pair_adjacent_faces,
)

BALL = icosphere(subdivisions=2)


@pytest.mark.parametrize("share", [0.0, 0.2, 0.45])
def test_the_flipped_minority_is_found(share: float) -> None:
    mesh = dome()
    flipped = np.random.default_rng(1).random(len(mesh.triangles)) < share
    triangles = flip_triangles(mesh.triangles, flipped)
    assert np.array_equal(find_inconsistent_faces(mesh.vertices, triangles), flipped)


def test_each_component_is_made_consistent_by_itself() -> None:
    mesh = dome()
    vertices = np.concatenate([mesh.vertices, mesh.vertices + 500])
    triangles = np.concatenate([mesh.triangles, mesh.triangles[:, ::-1] + len(mesh.vertices)])
    assert not find_inconsistent_faces(vertices, triangles).any()


def test_nothing_is_flipped_of_a_strip_that_cannot_be_oriented() -> None:
    assert not find_inconsistent_faces(*moebius_strip()).any()


def test_inside_out_holds_for_closed_and_open_surfaces() -> None:
    for vertices, triangles in (
        (np.array(BALL.vertices), np.array(BALL.faces)),
        (dome().vertices, dome().triangles),
    ):
        assert not is_inside_out(vertices, triangles)
        assert is_inside_out(vertices + 9, triangles[:, ::-1])


def test_area_vectors_of_a_closed_surface_add_up_to_nothing() -> None:
    vertices, triangles = np.array(BALL.vertices), np.array(BALL.faces)
    assert np.allclose(compute_area_vectors(vertices, triangles).sum(0), 0, atol=1e-12)
    assert compute_areas(vertices, triangles).sum() == pytest.approx(BALL.area)


def test_components_of_faces_need_a_common_edge() -> None:
    label = label_face_components(np.array([[0, 1, 2], [1, 3, 2], [3, 4, 5]]))
    assert label[0] == label[1] != label[2]


def test_adjacent_faces_are_compared_in_orientation() -> None:
    agree = pair_adjacent_faces(np.array([[0, 1, 2], [1, 3, 2]]))
    disagree = pair_adjacent_faces(np.array([[0, 1, 2], [1, 2, 3]]))
    assert (agree.first.tolist(), agree.second.tolist()) == ([0], [1])
    assert agree.same.tolist() == [False] and disagree.same.tolist() == [True]
