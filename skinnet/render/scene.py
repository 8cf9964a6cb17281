"""Ray casting against a mesh."""

from functools import cached_property

import numpy as np
from jaxtyping import Bool, Float, Int

from skinnet.errors import InputError
from skinnet.mesh._normals import compute_vertex_normals
from skinnet.mesh.mesh import Mesh
from skinnet.render._ray_caster import make_caster
from skinnet.render._ray_samples import build_tangents, rotate, sample_disc

BIAS = 1e-4
"""Distance from the surface at which shadow rays start, as a share of the mesh's extent."""

_SKY_RAYS = 128
"""Rays per vertex that sample the sky."""

_Hits = tuple[Int[np.ndarray, "rays"], Float[np.ndarray, "rays 3"]]
"""The first triangle on each ray, -1 for none, and the barycentric coordinates of the hit."""


class Scene:
    """A mesh prepared for ray casting; share one between several views of the same mesh.

    Rays are cast by Embree where it is installed, and otherwise, twenty to forty times slower, in
    NumPy. Embree works in single precision, so positions are centred and scaled before.

    Args:
        mesh: The surface; rays hit it from either side.

    Attributes:
        mesh: The surface.
        normals: Unit normals of its vertices.
        extent: Longest side of its bounding box.

    Raises:
        InputError: For a mesh without triangles, or with vertices that are not finite.

    Example:
        >>> import numpy as np
        >>> from skinnet.mesh import Mesh
        >>> from skinnet.render import Scene
        >>> scene = Scene(Mesh(np.eye(3), np.array([[0, 1, 2]])))
        >>> triangle, barycentric = scene.intersect(np.zeros((1, 3)), np.ones((1, 3)))
        >>> triangle, barycentric.round(3)
        (array([0]), array([[0.333, 0.333, 0.333]]))
    """

    def __init__(self, mesh: Mesh) -> None:
        if len(mesh.triangles) == 0 or not np.isfinite(mesh.vertices).all():
            raise InputError(
                f"{mesh.name} has no triangles, or vertices that are not finite; repair it first."
            )
        self.mesh = mesh
        self.normals = compute_vertex_normals(mesh.vertices, mesh.triangles)
        low, high = mesh.vertices.min(0), mesh.vertices.max(0)
        self.middle, self.extent = (low + high) / 2, float((high - low).max())
        self._caster = make_caster(self.to_local(mesh.vertices), mesh.triangles)

    def intersect(
        self, origins: Float[np.ndarray, "rays 3"], directions: Float[np.ndarray, "rays 3"]
    ) -> _Hits:
        """Find the first triangle that each ray hits, from either side.

        Args:
            origins: Start of each ray, in the mesh's unit.
            directions: Direction of each ray, of any length.

        Returns:
            Index of the triangle, -1 for a miss, and the barycentric coordinates of the hit.
        """
        triangle = self._caster.find_first(self.to_local(origins), directions)
        barycentric = np.zeros((len(triangle), 3))
        hit = triangle >= 0
        corners = self.mesh.vertices[self.mesh.triangles[triangle[hit]]]
        barycentric[hit] = _intersect_triangles(corners, origins[hit], directions[hit])
        return triangle, barycentric

    def occluded(
        self, starts: Float[np.ndarray, "rays 3"], directions: Float[np.ndarray, "#rays 3"]
    ) -> Bool[np.ndarray, "rays"]:
        """Tell whether each ray hits anything.

        Args:
            starts: Start of each ray in the frame of `to_local`.
            directions: Direction of each ray, or one for all.

        Returns:
            True where a ray hits the mesh.
        """
        return self._caster.is_blocked(starts, directions)

    @cached_property
    def outer_sky_visibility(self) -> Float[np.ndarray, "vertices"]:
        """Share of the cosine-weighted sky visible from the outside of each vertex."""
        return self._sky_visibility(self.normals)

    @cached_property
    def inner_sky_visibility(self) -> Float[np.ndarray, "vertices"]:
        """Share of the cosine-weighted sky visible from the inside of each vertex.

        The inside of a head is visible through holes at its eyes, and it is dark there.
        """
        return self._sky_visibility(-self.normals)

    def _sky_visibility(
        self, normals: Float[np.ndarray, "vertices 3"]
    ) -> Float[np.ndarray, "vertices"]:
        starts = self.to_local(self.mesh.vertices + BIAS * self.extent * normals)
        right, up = build_tangents(normals)
        angle = 2 * np.pi * np.random.default_rng(0).random((len(starts), 1))
        blocked = np.zeros(len(starts))
        for x, y in sample_disc(_SKY_RAYS):
            along, across = rotate(x, y, angle)
            height = np.sqrt(1 - x * x - y * y)
            blocked += self.occluded(starts, along * right + across * up + height * normals)
        return 1 - blocked / _SKY_RAYS

    def to_local(self, points: Float[np.ndarray, "points 3"]) -> Float[np.ndarray, "points 3"]:
        """Transform points to the rays' frame: centred, in units of the extent, single precision.

        Args:
            points: Positions in the mesh's unit.

        Returns:
            The points as float32.
        """
        return np.ascontiguousarray((points - self.middle) / (self.extent or 1), np.float32)


def _intersect_triangles(
    corners: Float[np.ndarray, "rays 3 3"],
    origins: Float[np.ndarray, "rays 3"],
    directions: Float[np.ndarray, "rays 3"],
) -> Float[np.ndarray, "rays 3"]:
    """Compute barycentric coordinates of hits in double precision (Moeller & Trumbore 1997)."""
    a, b, c = np.moveaxis(corners, 1, 0)
    ab, ac, away = b - a, c - a, origins - a
    p, q = np.cross(directions, ac), np.cross(away, ab)
    volume = np.einsum("px,px->p", ab, p)
    volume = np.where(volume == 0, np.inf, volume)
    second = (np.einsum("px,px->p", away, p) / volume).clip(0, 1)
    third = (np.einsum("px,px->p", directions, q) / volume).clip(0, 1 - second)
    return np.stack([1 - second - third, second, third], 1)
