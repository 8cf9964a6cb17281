"""A mesh that rays are cast at."""

from functools import cached_property
from typing import NamedTuple

import numpy as np
from embreex.mesh_construction import TriangleMesh
from embreex.rtcore_scene import EmbreeScene
from jaxtyping import Bool, Float, Int

from skinnet.errors import InputError
from skinnet.mesh.mesh import Mesh
from skinnet.mesh.normals import compute_vertex_normals, normalise

BIAS = 1e-4
"""Distance from the surface at which shadow rays start, as a share of the mesh's extent."""

SKY_RAYS = 128
"""Rays a vertex by which it is found how much of the sky it sees."""


class Hits(NamedTuple):
    """The first triangle on each ray, -1 for none, and where in it."""

    triangle: Int[np.ndarray, "rays"]
    barycentric: Float[np.ndarray, "rays 3"]


class Scene:
    """A mesh that rays can be cast at, by Embree in single precision around its middle."""

    def __init__(self, mesh: Mesh):
        if len(mesh.triangles) == 0 or not np.isfinite(mesh.vertices).all():
            raise InputError(f"{mesh.name} has no triangles or vertices that are not finite.")
        self.mesh = mesh
        self.normals = compute_vertex_normals(mesh.vertices, mesh.triangles)
        low, high = mesh.vertices.min(0), mesh.vertices.max(0)
        self.middle, self.extent = (low + high) / 2, float((high - low).max())
        self._embree = EmbreeScene(robust=True)
        TriangleMesh(self._embree, self.local(mesh.vertices), mesh.triangles.astype(np.int32))

    def first(
        self, origins: Float[np.ndarray, "rays 3"], directions: Float[np.ndarray, "rays 3"]
    ) -> Hits:
        """What each ray hits first, from either side."""
        found = self._embree.run(self.local(origins), directions.astype(np.float32))
        triangle = np.asarray(found, np.int64)
        barycentric = np.zeros((len(triangle), 3))
        hit = triangle >= 0
        corners = self.mesh.vertices[self.mesh.triangles[triangle[hit]]]
        barycentric[hit] = _crossing(corners, origins[hit], directions[hit])
        return Hits(triangle, barycentric)

    def blocked(
        self, starts: Float[np.ndarray, "rays 3"], directions: Float[np.ndarray, "#rays 3"]
    ) -> Bool[np.ndarray, "rays"]:
        """Whether each ray from `starts`, which are `local`, or one for all, hits anything."""
        towards = np.ascontiguousarray(directions, np.float32)
        found = self._embree.run(starts, towards, query="OCCLUDED")
        return np.asarray(found != -1)

    @cached_property
    def outer_openness(self) -> Float[np.ndarray, "vertices"]:
        """Share of the sky's cosine-weighted light that reaches each vertex from outside."""
        return self._openness(self.normals)

    @cached_property
    def inner_openness(self) -> Float[np.ndarray, "vertices"]:
        """The same from within: a head's inside, seen through the eyes' holes, is dark."""
        return self._openness(-self.normals)

    def _openness(self, normals: Float[np.ndarray, "vertices 3"]) -> Float[np.ndarray, "vertices"]:
        starts = self.local(self.mesh.vertices + BIAS * self.extent * normals)
        right, up = build_tangents(normals)
        turn = 2 * np.pi * np.random.default_rng(0).random((len(starts), 1))
        blocked = np.zeros(len(starts))
        for x, y in sample_disc(SKY_RAYS):
            along, across = rotate(x, y, turn)
            height = np.sqrt(1 - x * x - y * y)
            blocked += self.blocked(starts, along * right + across * up + height * normals)
        return 1 - blocked / SKY_RAYS

    def local(self, points: Float[np.ndarray, "points 3"]) -> Float[np.ndarray, "points 3"]:
        """Points as Embree gets them: about the mesh's middle in units of its extent, so that
        single precision is not spent on the distance from the origin."""
        return np.ascontiguousarray((points - self.middle) / (self.extent or 1), np.float32)


def _crossing(
    corners: Float[np.ndarray, "rays 3 3"],
    origins: Float[np.ndarray, "rays 3"],
    directions: Float[np.ndarray, "rays 3"],
) -> Float[np.ndarray, "rays 3"]:
    """Barycentric coordinates at which rays cross their triangles (Moeller and Trumbore 1997),
    in double precision; Embree's own are single."""
    a, b, c = np.moveaxis(corners, 1, 0)
    ab, ac, away = b - a, c - a, origins - a
    across, rotate = np.cross(directions, ac), np.cross(away, ab)
    volume = np.einsum("px,px->p", ab, across)
    volume = np.where(volume == 0, np.inf, volume)
    second = (np.einsum("px,px->p", away, across) / volume).clip(0, 1)
    third = (np.einsum("px,px->p", directions, rotate) / volume).clip(0, 1 - second)
    return np.stack([1 - second - third, second, third], 1)


def build_tangents(
    normals: Float[np.ndarray, "points 3"],
) -> tuple[Float[np.ndarray, "points 3"], Float[np.ndarray, "points 3"]]:
    """Two unit vectors square to each normal and to each other."""
    steep = np.abs(normals[:, :1]) > 0.6
    axis = np.where(steep, [[0.0, 1.0, 0.0]], [[1.0, 0.0, 0.0]])
    right = normalise(np.cross(axis, normals))
    return right, np.cross(normals, right)


def rotate(
    x: float, y: float, turn: Float[np.ndarray, "points 1"]
) -> tuple[Float[np.ndarray, "points 1"], Float[np.ndarray, "points 1"]]:
    """A point of the plane turned about the origin by many angles."""
    cosine, sine = np.cos(turn), np.sin(turn)
    return x * cosine - y * sine, x * sine + y * cosine


def sample_disc(count: int) -> Float[np.ndarray, "count 2"]:
    """Points evenly over the unit disc, a sunflower's seeds; seen as heights of a hemisphere they
    are cosine-weighted directions."""
    number = np.arange(count)
    radius, angle = np.sqrt((number + 0.5) / count), number * np.pi * (3 - np.sqrt(5))
    return np.stack([radius * np.cos(angle), radius * np.sin(angle)], 1)
