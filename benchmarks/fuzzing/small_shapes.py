"""A small face-like surface and a shape model of it."""

from functools import cache

import numpy as np

from skinnet.mesh.mesh import Mesh
from skinnet.shape.model import ShapeModel

ROWS, COLUMNS = 9, 7


@cache
def make_dome() -> Mesh:
    """A textured patch of a sphere that faces +z; its uv are a grid."""
    v, u = np.meshgrid(np.linspace(1, 0, ROWS), np.linspace(0, 1, COLUMNS), indexing="ij")
    x, y = (u.ravel() - 0.5) * 0.8, v.ravel() - 0.5
    vertices = 180 * np.stack([x, y, np.sqrt(1 - x**2 - y**2)], 1)
    first = (np.arange(ROWS - 1)[:, None] * COLUMNS + np.arange(COLUMNS - 1)).ravel()
    below = first + COLUMNS
    upper = np.stack([first, below, below + 1], 1)
    triangles = np.concatenate([upper, np.stack([first, below + 1, first + 1], 1)])
    texture = np.random.default_rng(0).integers(0, 256, (16, 12, 3), np.uint8)
    uv = np.stack([u.ravel(), v.ravel()], 1)
    return Mesh(vertices, triangles, uv, triangles, texture, "dome")


@cache
def make_model() -> ShapeModel:
    """A model of three modes with three landmarks."""
    mesh = make_dome()
    random = np.random.default_rng(1).normal(size=(mesh.vertices.size, 3))
    return ShapeModel(
        mesh.vertices,
        np.linalg.qr(random)[0].T.reshape(3, -1, 3),
        np.array([9.0, 4, 1]),
        mesh.triangles,
        mesh.uv,
        mesh.uv_triangles,
        {"right_eye_outer": 15, "left_eye_outer": 19, "nose_tip": 31},
    )
