"""Pictures of what a command has made."""

import numpy as np
from jaxtyping import Float, UInt8

from skinnet.inference.panel import TILE, _draw_map, draw_grid, draw_picture
from skinnet.mesh.mesh import Mesh
from skinnet.render.lights import DirectionalLight, SphericalHarmonics
from skinnet.render.rendering import render
from skinnet.render.views import PerspectiveView, frame_face
from skinnet.render.visibility import trace_geometry
from skinnet.shape.registration import Registration

PLASTER = np.array([0.55, 0.53, 0.5])
DISTANCE_TOP = 3.0
"""Distance in mm at the end of the scale of a picture of a fit."""

SIDE = TILE
_DISTANCE = ((28, 70, 120), (120, 180, 200), (245, 235, 200), (230, 140, 70), (150, 20, 40))
_BACKDROP = (0.75, 0.75, 0.75)


def fit_sheet(scan: Mesh, model: Mesh, found: Registration) -> UInt8[np.ndarray, "h w 3"]:
    """The scan, the model fitted to it, and how far they are apart, from ahead."""
    view = frame_face(model.vertices, (SIDE, SIDE))
    buffers = trace_geometry(model, view)
    corners = model.triangles[buffers.triangle]
    distance = np.zeros(buffers.hit.shape)
    distance[buffers.hit] = (found.distances[corners] * buffers.barycentric).sum(1)
    tiles = (
        draw_picture("scan", plaster(scan, view)),
        draw_picture("fitted model", plaster(model, view)),
        _draw_map(
            "distance to the scan",
            distance,
            buffers.hit.astype(np.float64),
            "mm",
            _DISTANCE,
            DISTANCE_TOP,
        ),
    )
    return draw_grid(tiles, len(tiles))


def plaster(mesh: Mesh, view: PerspectiveView) -> UInt8[np.ndarray, "height width 3"]:
    """A mesh as a cast, its texture left aside."""
    return lit(mesh, PLASTER, view)


def lit(
    mesh: Mesh,
    albedo: Float[np.ndarray, "*texels 3"],
    view: PerspectiveView,
    specular: float = 0.0,
) -> UInt8[np.ndarray, "height width 3"]:
    """A mesh before a wall, under a lamp with soft shadows and a pale sky."""
    lights = (
        DirectionalLight((-0.45, 0.55, 0.75), 0.75, angle=6.0),
        SphericalHarmonics.sky((0.55, 0.57, 0.6), (0.2, 0.2, 0.2)),
    )
    return render(mesh, albedo, lights, view, specular=specular, background=_BACKDROP)
