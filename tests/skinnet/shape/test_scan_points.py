"""A scan as a dense cloud: distances, open edges, spikes."""

import numpy as np
import trimesh

from skinnet.mesh.mesh import Mesh
from skinnet.shape._scan_points import DENSE, ScanPoints, find_spikes
from skinnet.shape.similarity import fit_similarity


def sphere(subdivisions: int = 4) -> Mesh:
    ball = trimesh.creation.icosphere(subdivisions=subdivisions)
    return Mesh(np.array(ball.vertices), np.array(ball.faces), name="a sphere")


def closest(mesh: Mesh, query: np.ndarray) -> float:
    """Distance to the nearest of all triangles."""
    corners = mesh.vertices[mesh.triangles]
    points = trimesh.triangles.closest_point(corners, np.tile(query, (len(corners), 1)))
    return np.linalg.norm(points - query, axis=1).min()


def test_distances_to_a_subdivided_sphere():
    ball = sphere()
    surface = ScanPoints(ball)
    assert len(surface.points) >= DENSE
    draw = np.random.default_rng(0)
    queries = draw.normal(size=(40, 3))
    exact = [closest(ball, query) for query in queries]
    across = surface.find_nearest(queries).measure_distance(queries)
    np.testing.assert_allclose(across, exact, atol=2e-3)
    assert not surface.on_boundary.any()


def test_the_open_edge_of_a_half_sphere():
    ball = sphere()
    upper = ball.triangles[(ball.vertices[ball.triangles][..., 2] > -1e-9).all(1)]
    surface = ScanPoints(Mesh(ball.vertices, upper, name="a half sphere"))
    below = np.array([[1.2, 0.0, -0.5], [0.0, 0.0, 1.1]])
    nearest = surface.find_nearest(below)
    assert nearest.on_boundary.tolist() == [True, False]
    assert nearest.measure_distance(below)[0] == nearest.distance[0]


def test_spikes_are_found_and_cut_off():
    ball = sphere()
    bent = ball.vertices.copy()
    bent[100] *= 1.8
    assert np.flatnonzero(find_spikes(bent, ball.triangles)).tolist() == [100]
    surface = ScanPoints(Mesh(bent, ball.triangles, name="a sphere with a spike"))
    assert np.linalg.norm(surface.points, axis=1).max() < 1.01


def test_a_finer_patch_is_no_spike():
    ball = sphere(3)
    part = np.arange(len(ball.triangles)) < 200
    finer = trimesh.remesh.subdivide(ball.vertices, ball.triangles, face_index=np.flatnonzero(part))
    assert not find_spikes(*finer).any()


def test_similarity_and_the_best_mirrored_one():
    draw = np.random.default_rng(1)
    source = draw.normal(size=(12, 3))
    turn = np.linalg.qr(draw.normal(size=(3, 3)))[0]
    turn *= np.sign(np.linalg.det(turn))
    target = 3 * source @ turn.T + [1, 2, 3]
    found = fit_similarity(source, target)
    np.testing.assert_allclose(found(source), target, atol=1e-12)
    np.testing.assert_allclose(found.apply_inverse(target), source, atol=1e-12)
    mirrored = fit_similarity(source * [-1, 1, 1], target, reflection=True)
    np.testing.assert_allclose(mirrored(source * [-1, 1, 1]), target, atol=1e-12)
    assert np.linalg.det(mirrored.rotation) < 0
    plain = fit_similarity(source * [-1, 1, 1], target)
    assert np.abs(plain(source * [-1, 1, 1]) - target).max() > 0.5
