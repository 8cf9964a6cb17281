"""Cutting and joining of labelled meshes."""

import numpy as np
import pytest

from skinnet.mesh._topology import find_boundary_edges
from train.synthetic.bodies.labelled_mesh import (
    LabelledMesh,
    clip,
    join,
    label_mesh,
    mirror,
    triangulate_grid,
)
from train.synthetic.labels import EYE, SKIN


@pytest.fixture
def square() -> LabelledMesh:
    x, y = np.meshgrid(np.linspace(-1, 1, 8), np.linspace(1, -1, 8))
    points = np.stack([x, y, 0 * x], -1).reshape(-1, 3)
    return label_mesh(points, triangulate_grid(8, 8), SKIN, points[:, :2] * 2)


def test_a_grid_faces_the_viewer(square: LabelledMesh) -> None:
    assert (_areas(square)[:, 2] > 0).all()


def test_a_cut_keeps_area_chart_and_orientation(square: LabelledMesh) -> None:
    value = square.vertices[:, 0] + 0.3 * square.vertices[:, 1] - 0.123
    right, left = clip(square, value), clip(square, -value, EYE)
    assert _areas(right)[:, 2].sum() + _areas(left)[:, 2].sum() == pytest.approx(8)
    assert (_areas(right)[:, 2] > -1e-12).all()
    np.testing.assert_allclose(right.chart, 2 * right.vertices[:, :2], atol=1e-12)
    assert set(right.label) == {SKIN} and set(left.label) == {EYE}
    assert (right.vertices @ [1, 0.3, 0] > 0.123 - 1e-12).all()


def test_a_cut_leaves_no_gaps(square: LabelledMesh) -> None:
    cut = clip(square, 0.6 - np.hypot(*square.vertices[:, :2].T))
    boundary = find_boundary_edges(cut.triangles)
    rim = cut.triangles[boundary.any(1)]
    assert np.hypot(*cut.vertices[rim].reshape(-1, 3)[:, :2].T).max() < 0.7
    edges = (3 * len(cut.triangles) + boundary.sum()) / 2
    assert len(cut.vertices) - edges + len(cut.triangles) == pytest.approx(1)


def test_a_mirror_image_faces_the_same_way(square: LabelledMesh) -> None:
    both = join([square, mirror(square)])
    assert (_areas(both)[:, 2] > 0).all()
    assert len(both.vertices) == 2 * len(square.vertices)


def _areas(whole: LabelledMesh) -> np.ndarray:
    a, b, c = np.moveaxis(whole.vertices[whole.triangles], 1, 0)
    return np.cross(b - a, c - a)
