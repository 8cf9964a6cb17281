"""The surface visible in a picture, and its visibility from lights and sky."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from jaxtyping import Bool, Float, Int

from skinnet.mesh._barycentric import interpolate
from skinnet.mesh._vectors import normalise
from skinnet.mesh.mesh import Mesh
from skinnet.render._ray_samples import build_tangents, rotate, sample_disc
from skinnet.render.scene import BIAS, Scene
from skinnet.render.views import View


@dataclass(frozen=True)
class GeometryBuffers:
    """The surface under each sample of a picture, in flat arrays over the samples that hit it.

    Attributes:
        scene: The mesh that was hit.
        samples: Samples of a pixel along either side.
        hit: Whether each sample hits the mesh, [H, W] over samples.
        triangle: Index of the triangle.
        barycentric: Barycentric coordinates in it.
        position: Position in the mesh's unit.
        normal: Interpolated unit normal, facing the viewer.
        face_normal: The triangle's unit normal, facing the viewer.
        side: 1 where the outside is visible, -1 where the inside is and both normals are reversed.
        view_direction: Unit vector to the viewer.
        uv: Texture coordinates; None for a mesh without them.
    """

    scene: Scene
    samples: int
    hit: Bool[np.ndarray, "height width"]
    triangle: Int[np.ndarray, "hits"]
    barycentric: Float[np.ndarray, "hits 3"]
    position: Float[np.ndarray, "hits 3"]
    normal: Float[np.ndarray, "hits 3"]
    face_normal: Float[np.ndarray, "hits 3"]
    side: Float[np.ndarray, "hits 1"]
    view_direction: Float[np.ndarray, "hits 3"]
    uv: Float[np.ndarray, "hits 2"] | None

    @cached_property
    def shadow_origin(self) -> Float[np.ndarray, "hits 3"]:
        """Start of the shadow rays, a little above the smooth surface that the normals describe.

        Rays that start on the flat triangle hit its neighbours at grazing angles. So the start is
        moved up to the tangent planes of the triangle's corners, with barycentric weights (Hanika
        2021, "Hacking the shadow terminator").
        """
        corners = self.scene.mesh.triangles[self.triangle]
        raised = self.position.copy()
        for k in range(3):
            vertex, normal = corners[:, k], self.side * self.scene.normals[corners[:, k]]
            off = self.position - self.scene.mesh.vertices[vertex]
            below = np.einsum("px,px->p", off, normal).clip(max=0)
            raised -= (self.barycentric[:, k] * below)[:, None] * normal
        return raised + BIAS * self.scene.extent * self.face_normal

    def light_visibility(
        self, direction: Float[np.ndarray, "3"], angle: float = 0.0, rays: int = 16
    ) -> Float[np.ndarray, "hits"]:
        """Compute the share of a distant light that is visible from each sample.

        Args:
            direction: Unit vector to the middle of the light.
            angle: Angular diameter of the light in degrees.
            rays: Rays per pixel, spread over the light and rotated at random for each sample.

        Returns:
            From 0 to 1; 0 where the surface faces away.
        """
        facing = np.flatnonzero(self.normal @ direction > 0)
        start = self.scene.to_local(self.shadow_origin[facing] + self._offset(direction, facing))
        aims = sample_disc(-(-rays // self.samples**2)) if angle else np.zeros((1, 2))
        right, up = build_tangents(direction[None])
        rotation = 2 * np.pi * np.random.default_rng(0).random((len(facing) if angle else 1, 1))
        blocked = np.zeros(len(facing))
        for x, y in np.tan(np.deg2rad(angle) / 2) * aims:
            along, across = rotate(x, y, rotation)
            blocked += self.scene.occluded(start, direction + along * right + across * up)
        visibility = np.zeros(len(self.position))
        visibility[facing] = 1 - blocked / len(aims)
        return visibility

    def _offset(
        self, direction: Float[np.ndarray, "3"], chosen: Int[np.ndarray, "chosen"]
    ) -> Float[np.ndarray, "chosen 3"]:
        """Compute offsets of one edge length towards the light where it is behind the triangle.

        There the interpolated normal faces the light and that of the triangle does not. Without
        the offset such triangles of a coarse mesh are dark.
        """
        behind = np.flatnonzero(self.face_normal[chosen] @ direction < 0)
        triangles = self.scene.mesh.triangles[self.triangle[chosen[behind]]]
        corners = self.scene.mesh.vertices[triangles]
        longest = np.linalg.norm(corners - np.roll(corners, 1, 1), axis=2).max(1)
        offset = np.zeros((len(chosen), 3))
        offset[behind] = longest[:, None] * direction
        return offset

    def sky_visibility(self) -> Float[np.ndarray, "hits"]:
        """Compute the share of the cosine-weighted sky that is visible from each sample.

        Returns:
            From 0 to 1, interpolated between vertices (`Scene.outer_sky_visibility`, or
            `inner_sky_visibility` where the inside is visible).
        """
        corners = self.scene.mesh.triangles[self.triangle]
        visibility = (self.scene.outer_sky_visibility[corners] * self.barycentric).sum(1)
        visibility = np.asarray(visibility)
        within = self.side[:, 0] < 0
        if within.any():
            inner = self.scene.inner_sky_visibility[corners[within]]
            visibility[within] = (inner * self.barycentric[within]).sum(1)
        return visibility


def trace_geometry(mesh: Mesh | Scene, view: View, samples: int = 1) -> GeometryBuffers:
    """Trace rays through `samples` x `samples` positions of every pixel to the visible surface.

    Args:
        mesh: A mesh, or a `Scene` of it to share between several views.
        view: Where the picture is taken from.
        samples: Samples of a pixel along either side.

    Returns:
        What the rays hit.

    Example:
        >>> import numpy as np
        >>> from skinnet.mesh import Mesh
        >>> from skinnet.render import frame_face, trace_geometry
        >>> square = np.array([[-1.0, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]])
        >>> mesh = Mesh(square, np.array([[0, 1, 2], [0, 2, 3]]))
        >>> buffers = trace_geometry(mesh, frame_face(square, (8, 8), fill=0.5))
        >>> buffers.hit.astype(int)[1:4]
        array([[0, 0, 0, 0, 0, 0, 0, 0],
               [0, 0, 1, 1, 1, 1, 0, 0],
               [0, 0, 1, 1, 1, 1, 0, 0]])
        >>> buffers.normal[0]
        array([0., 0., 1.])
    """
    scene = mesh if isinstance(mesh, Scene) else Scene(mesh)
    origins, directions = view.rays(samples)
    triangle, barycentric = scene.intersect(origins, directions)
    hit = triangle >= 0
    triangle, barycentric = triangle[hit], barycentric[hit]
    mesh, towards = scene.mesh, -directions[hit]
    corners = mesh.triangles[triangle]
    a, b, c = np.moveaxis(mesh.vertices[corners], 1, 0)
    face_normal = normalise(np.cross(b - a, c - a))
    side = np.where(np.einsum("px,px->p", face_normal, towards) < 0, -1.0, 1.0)[:, None]
    uv = None
    if mesh.uv is not None and mesh.uv_triangles is not None:
        uv = interpolate(barycentric, mesh.uv[mesh.uv_triangles[triangle]])
    return GeometryBuffers(
        scene,
        samples,
        hit.reshape(view.size[0] * samples, -1),
        triangle,
        barycentric,
        interpolate(barycentric, mesh.vertices[corners]),
        side * normalise(interpolate(barycentric, scene.normals[corners])),
        side * face_normal,
        side,
        towards,
        uv,
    )
