"""A scan as dense points: distances, boundaries, spikes."""

import numpy as np
import trimesh

from skinnet.mesh.mesh import Mesh
from skinnet.shape._scan_points import MIN_POINTS, ScanPoints, find_spikes


def sphere(subdivisions: int = 4) -> Mesh:
    ball = trimesh.creation.icosphere(subdivisions=subdivisions)
    return Mesh(np.array(ball.vertices), np.array(ball.faces), name="a sphere")


def measure_exactly(mesh: Mesh, query: np.ndarray) -> float:
    """Distance to the nearest of all triangles."""
    corners = mesh.vertices[mesh.triangles]
    points = trimesh.triangles.closest_point(corners, np.tile(query, (len(corners), 1)))
    return float(np.linalg.norm(points - query, axis=1).min())


def test_distances_to_a_subdivided_sphere() -> None:
    ball = sphere()
    scan = ScanPoints(ball)
    assert len(scan.points) >= MIN_POINTS
    rng = np.random.default_rng(0)
    queries = rng.normal(size=(40, 3))
    exact = [measure_exactly(ball, query) for query in queries]
    across = scan.find_nearest(queries).measure_distance(queries)
    np.testing.assert_allclose(across, exact, atol=2e-3)
    assert not scan.on_boundary.any()


def test_the_open_edge_of_a_half_sphere() -> None:
    ball = sphere()
    upper = ball.triangles[(ball.vertices[ball.triangles][..., 2] > -1e-9).all(1)]
    scan = ScanPoints(Mesh(ball.vertices, upper, name="a half sphere"))
    below = np.array([[1.2, 0.0, -0.5], [0.0, 0.0, 1.1]])
    nearest = scan.find_nearest(below)
    assert nearest.on_boundary.tolist() == [True, False]
    assert nearest.measure_distance(below)[0] == nearest.distance[0]


def test_spikes_are_found_and_cut_off() -> None:
    ball = sphere()
    bent = ball.vertices.copy()
    bent[100] *= 1.8
    assert np.flatnonzero(find_spikes(bent, ball.triangles)).tolist() == [100]
    scan = ScanPoints(Mesh(bent, ball.triangles, name="a sphere with a spike"))
    assert np.linalg.norm(scan.points, axis=1).max() < 1.01


def test_a_finer_patch_is_no_spike() -> None:
    ball = sphere(3)
    part = np.arange(len(ball.triangles)) < 200
    finer = trimesh.remesh.subdivide(ball.vertices, ball.triangles, face_index=np.flatnonzero(part))
    assert not find_spikes(*finer).any()
