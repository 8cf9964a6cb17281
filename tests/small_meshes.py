"""Small meshes and models for the tests."""

import numpy as np

from skinnet.mesh.mesh import Mesh
from skinnet.shape.model import ShapeModel

ROWS, COLUMNS = 9, 7


def dome(rows: int = ROWS, columns: int = COLUMNS, height: float = 180.0) -> Mesh:
    """A textured patch of a sphere that faces +z, `height` tall; its uv are the grid."""
    v, u = np.meshgrid(np.linspace(1, 0, rows), np.linspace(0, 1, columns), indexing="ij")
    x, y = (u.ravel() - 0.5) * 0.8, v.ravel() - 0.5
    vertices = height * np.stack([x, y, np.sqrt(1 - x**2 - y**2)], 1)
    first = (np.arange(rows - 1)[:, None] * columns + np.arange(columns - 1)).ravel()
    below = first + columns
    triangles = np.concatenate(
        [np.stack([first, below, below + 1], 1), np.stack([first, below + 1, first + 1], 1)]
    )
    uv = np.stack([u.ravel(), v.ravel()], 1)
    rng = np.random.default_rng(0)
    texture = rng.integers(0, 256, (16, 12, 3), np.uint8)
    return Mesh(vertices, triangles, uv, triangles, texture, "dome")


def moebius_strip(count: int = 24) -> tuple[np.ndarray, np.ndarray]:
    """Vertices and triangles of a strip with one side."""
    angle = np.linspace(0, 2 * np.pi, count, endpoint=False)
    ring = np.stack([np.cos(angle), np.sin(angle), 0 * angle], 1)
    side = np.cos(angle / 2)[:, None] * ring + np.sin(angle / 2)[:, None] * [0, 0, 1]
    vertices = np.stack([ring - side / 3, ring + side / 3], 1).reshape(-1, 3)
    a = 2 * np.arange(count)
    b, c, d = a + 1, (a + 2) % (2 * count), (a + 3) % (2 * count)
    c[-1], d[-1] = 1, 0
    return vertices, np.concatenate([np.stack([a, b, c], 1), np.stack([b, d, c], 1)])


def small_model(modes: int = 3) -> ShapeModel:
    """A model of the dome with random orthonormal modes and six named vertices."""
    mesh = dome()
    rng = np.random.default_rng(1)
    basis = np.linalg.qr(rng.normal(size=(mesh.vertices.size, modes)))[0].T
    return ShapeModel(
        mesh.vertices,
        basis.reshape(modes, -1, 3),
        np.arange(modes, 0, -1.0) ** 2,
        mesh.triangles,
        mesh.uv,
        mesh.uv_triangles,
        LANDMARKS,
        name="small",
    )


LANDMARKS = {
    "right_eye_outer": 2 * COLUMNS + 1,
    "left_eye_outer": 2 * COLUMNS + COLUMNS - 2,
    "nose_tip": 4 * COLUMNS + COLUMNS // 2,
    "mouth_right": 6 * COLUMNS + 1,
    "mouth_left": 6 * COLUMNS + COLUMNS - 2,
    "chin": 8 * COLUMNS + COLUMNS // 2,
}
