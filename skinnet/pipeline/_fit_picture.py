"""The picture of a fit: scan, fitted model, and the distance between them."""

import numpy as np
from jaxtyping import UInt8

from skinnet.inference._colour_scales import DISTANCE
from skinnet.inference._tiles import draw_grid, draw_map, draw_picture
from skinnet.mesh.mesh import Mesh
from skinnet.pipeline import relight
from skinnet.render.lights import DirectionalLight, SphericalHarmonics
from skinnet.render.rendering import render
from skinnet.render.views import PerspectiveView, frame_face
from skinnet.render.visibility import trace_geometry
from skinnet.shape.registration import Registration

_PLASTER = np.array([0.55, 0.53, 0.5])
"""Albedo of plaster, linear RGB."""

_BACKDROP = (0.75, 0.75, 0.75)


def draw_fit(scan: Mesh, model: Mesh, fit: Registration) -> UInt8[np.ndarray, "h w 3"]:
    """Draw the scan, the fitted model and the distance between them, from the front."""
    view = frame_face(model.vertices, (relight.TILE_SIZE, relight.TILE_SIZE))
    buffers = trace_geometry(model, view)
    corners = model.triangles[buffers.triangle]
    distance = np.zeros(buffers.hit.shape)
    distance[buffers.hit] = (fit.distances[corners] * buffers.barycentric).sum(1)
    tiles = (
        draw_picture("scan", _render_plaster(scan, view)),
        draw_picture("fitted model", _render_plaster(model, view)),
        draw_map("distance to the scan", distance, buffers.hit.astype(np.float64), DISTANCE),
    )
    return draw_grid(tiles, len(tiles))


def _render_plaster(mesh: Mesh, view: PerspectiveView) -> UInt8[np.ndarray, "height width 3"]:
    """Render a mesh as grey plaster, under a lamp with soft shadows and a sky."""
    lights = (
        DirectionalLight((-0.45, 0.55, 0.75), 0.75, angle=6.0),
        SphericalHarmonics.sky((0.55, 0.57, 0.6), (0.2, 0.2, 0.2)),
    )
    return render(mesh, _PLASTER, lights, view, background=_BACKDROP)
