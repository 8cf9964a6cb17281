"""The surface that a camera sees, and what stands between it and the light."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from jaxtyping import Bool, Float, Int

from skinnet.mesh.mesh import Mesh
from skinnet.mesh.normals import normalise
from skinnet.render.scene import BIAS, Scene, build_tangents, rotate, sample_disc
from skinnet.render.views import View


@dataclass(frozen=True)
class GeometryBuffers:
    """The surface under each sample of a picture, in flat arrays over those that hit it.

    `hit` is [H, W] over samples, `samples` of which make a pixel along either side. `normal` is
    interpolated, `face` the triangle's; both look to the camera's side, for which they were
    multiplied by `side`, -1 where the surface is seen from within. `towards` is the unit direction
    to the camera, `uv` None for a mesh without texture coordinates.
    """

    scene: Scene
    samples: int
    hit: Bool[np.ndarray, "height width"]
    triangle: Int[np.ndarray, "hits"]
    barycentric: Float[np.ndarray, "hits 3"]
    position: Float[np.ndarray, "hits 3"]
    normal: Float[np.ndarray, "hits 3"]
    face: Float[np.ndarray, "hits 3"]
    side: Float[np.ndarray, "hits 1"]
    towards: Float[np.ndarray, "hits 3"]
    uv: Float[np.ndarray, "hits 2"] | None

    @cached_property
    def start(self) -> Float[np.ndarray, "hits 3"]:
        """Where shadow rays start: a little off the smooth surface that the normals describe.

        A ray from the flat triangle meets its neighbours wherever light grazes the smooth normals;
        raised onto the corners' tangent planes it passes over them (Hanika 2021).
        """
        corners = self.scene.mesh.triangles[self.triangle]
        raised = self.position.copy()
        for k in range(3):
            vertex, normal = corners[:, k], self.side * self.scene.normals[corners[:, k]]
            off = self.position - self.scene.mesh.vertices[vertex]
            below = np.einsum("px,px->p", off, normal).clip(max=0)
            raised -= (self.barycentric[:, k] * below)[:, None] * normal
        return raised + BIAS * self.scene.extent * self.face

    def lit(
        self, direction: Float[np.ndarray, "3"], angle: float = 0.0, rays: int = 16
    ) -> Float[np.ndarray, "hits"]:
        """Share of a distant light, `angle` degrees across, that nothing hides from each sample.

        `direction`, a unit vector, points to its middle. `rays` a pixel go to places spread over
        it, those of each sample turned at random. 0 where the surface looks away.
        """
        facing = np.flatnonzero(self.normal @ direction > 0)
        start = self.scene.local(self.start[facing] + self._skip(direction, facing))
        aims = sample_disc(-(-rays // self.samples**2)) if angle else np.zeros((1, 2))
        right, up = build_tangents(direction[None])
        turn = 2 * np.pi * np.random.default_rng(0).random((len(facing) if angle else 1, 1))
        blocked = np.zeros(len(facing))
        for x, y in np.tan(np.deg2rad(angle) / 2) * aims:
            along, across = rotate(x, y, turn)
            blocked += self.scene.blocked(start, direction + along * right + across * up)
        reached = np.zeros(len(self.position))
        reached[facing] = 1 - blocked / len(aims)
        return reached

    def _skip(
        self, direction: Float[np.ndarray, "3"], chosen: Int[np.ndarray, "chosen"]
    ) -> Float[np.ndarray, "chosen 3"]:
        """A triangle's length towards a light from which the triangle turns and the smooth normal
        does not: without it a coarse mesh is dappled with dark triangles."""
        rotate = np.flatnonzero(self.face[chosen] @ direction < 0)
        triangles = self.scene.mesh.triangles[self.triangle[chosen[rotate]]]
        corners = self.scene.mesh.vertices[triangles]
        longest = np.linalg.norm(corners - np.roll(corners, 1, 1), axis=2).max(1)
        skip = np.zeros((len(chosen), 3))
        skip[rotate] = longest[:, None] * direction
        return skip

    def openness(self) -> Float[np.ndarray, "hits"]:
        """Share of the sky's light that reaches each sample, from the vertices' own."""
        corners = self.scene.mesh.triangles[self.triangle]
        open_ = np.asarray((self.scene.outer_openness[corners] * self.barycentric).sum(1))
        within = self.side[:, 0] < 0
        if within.any():
            inner = self.scene.inner_openness[corners[within]]
            open_[within] = (inner * self.barycentric[within]).sum(1)
        return open_


def trace_geometry(mesh: Mesh | Scene, view: View, samples: int = 1) -> GeometryBuffers:
    """The surface that a camera sees, at `samples` x `samples` places of every pixel.

    Hand in a `Scene` to take several views of one mesh.
    """
    scene = mesh if isinstance(mesh, Scene) else Scene(mesh)
    rays = view.rays(samples)
    hits = scene.first(*rays)
    hit = hits.triangle >= 0
    triangle, barycentric = hits.triangle[hit], hits.barycentric[hit]
    mesh, towards = scene.mesh, -rays.directions[hit]
    corners = mesh.triangles[triangle]
    a, b, c = np.moveaxis(mesh.vertices[corners], 1, 0)
    face = normalise(np.cross(b - a, c - a))
    side = np.where(np.einsum("px,px->p", face, towards) < 0, -1.0, 1.0)[:, None]
    uv = None
    if mesh.uv is not None and mesh.uv_triangles is not None:
        uv = _mean(barycentric, mesh.uv[mesh.uv_triangles[triangle]])
    return GeometryBuffers(
        scene,
        samples,
        hit.reshape(view.size[0] * samples, -1),
        triangle,
        barycentric,
        _mean(barycentric, mesh.vertices[corners]),
        side * normalise(_mean(barycentric, scene.normals[corners])),
        side * face,
        side,
        towards,
        uv,
    )


def _mean(
    barycentric: Float[np.ndarray, "points 3"], corners: Float[np.ndarray, "points 3 k"]
) -> Float[np.ndarray, "points k"]:
    return np.asarray(np.einsum("pk,pkx->px", barycentric, corners))
