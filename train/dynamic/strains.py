"""How expressions stretch the skin, by ICT-FaceKit's shapes, on the chart of the dynamic model."""

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy import ndimage
from scipy.interpolate import LinearNDInterpolator
from scipy.spatial import Delaunay

from train.synthetic.bodies.ict_model import IctModel
from train.synthetic.labels import SKIN

_LAW, _MOST = 0.5, 0.2
"""Log hemoglobin for each log area, with the sign turned, and its largest change."""

_SMOOTH = 0.018
"""Reach of the smoothing in sides of the chart: blood does not change at a crease alone."""

_FRONT, _WIDE = 2.0, 1.4
"""Largest azimuth and elevation of the vertices that are used, in radians."""


def draw_strains(
    model: IctModel,
    angles: Float[np.ndarray, "size size 2"],
    landmarks: Float[np.ndarray, "478 2"],
) -> Float[np.ndarray, "shapes size size"]:
    """Draw the log change of hemoglobin by each expression at a weight of 1.

    Args:
        model: ICT-FaceKit.
        angles: Azimuth and elevation of the chart's texels in radians; NaN where there is no skin.
        landmarks: Places of the landmarks on the chart, from 0 to 1.
    """
    triangles = model.triangles[model.label == SKIN]
    rest = _measure_areas(model.mean, triangles)
    near = (np.abs(model.chart[:, 0]) < _FRONT) & (np.abs(model.chart[:, 1]) < _WIDE)
    used = np.flatnonzero(near & (rest > 0))
    logs = np.stack(
        [
            np.log(_measure_areas(model.mean + shape, triangles)[used] / rest[used])
            for shape in model.expressions
        ],
        1,
    )
    find = LinearNDInterpolator(model.chart[used], -_LAW * logs.clip(-1, 1))
    known = np.isfinite(angles).all(-1) & _mark_mesh(landmarks, len(angles))
    drawn = np.nan_to_num(find(np.where(known[..., None], angles, 0)))
    size = len(angles)
    fields = [
        ndimage.gaussian_filter(np.where(known, one, 0), _SMOOTH * size)
        for one in np.moveaxis(drawn, -1, 0)
    ]
    return np.stack(fields).clip(-_MOST, _MOST)


def _mark_mesh(landmarks: Float[np.ndarray, "478 2"], size: int) -> Bool[np.ndarray, "size size"]:
    """Mark the texels within the face; what moves beyond is the neck, as a whole."""
    line = (np.arange(size) + 0.5) / size
    inside = Delaunay(landmarks).find_simplex(np.stack(np.meshgrid(line, line), -1)) >= 0
    return np.asarray(inside)


def _measure_areas(
    vertices: Float[np.ndarray, "vertices 3"], triangles: Int[np.ndarray, "triangles 3"]
) -> Float[np.ndarray, "vertices"]:
    """Sum of the areas of the triangles at each vertex; 0 where there are none."""
    first, second, third = (vertices[triangles[:, corner]] for corner in range(3))
    area = np.linalg.norm(np.cross(second - first, third - first), axis=-1) / 2
    return np.bincount(triangles.ravel(), np.repeat(area, 3), len(vertices))
