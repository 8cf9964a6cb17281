"""Synthetic faces on one chart: its landmarks, and maps of hemoglobin at rest."""

from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from skinnet.errors import InputError
from skinnet.images.faces._face_chart import normalise_landmarks, warp_to_chart
from skinnet.images.faces._face_mesh import MESH_POINTS
from train.synthetic.videos.clip_renderer import ClipRenderer, ClipSettings
from train.synthetic.videos.clips import Clips

_EYES, _NOSE = (33, 263), 1
_FRONTAL, _TURNED = 0.03, 0.09
"""Largest asymmetry, in sides of the chart, of faces that place the landmarks, and of faces whose
maps are used."""


class ChartedFaces(NamedTuple):
    """Faces on a chart.

    Attributes:
        landmarks: Where the landmarks lie on it, from 0 to 1, [478, 2].
        hemoglobin: Volume fractions at rest, NaN where no skin is seen, [faces, size, size].
        angles: Mean azimuth and elevation of each texel, NaN where none is seen, [size, size, 2].
    """

    landmarks: Float[np.ndarray, "478 2"]
    hemoglobin: Float[np.ndarray, "faces size size"]
    angles: Float[np.ndarray, "size size 2"]


def chart_faces(count: int, size: int, seed: int, ict: str | None, geometry: str) -> ChartedFaces:
    """Render faces and lay them out on the chart of their mean landmarks.

    Args:
        count: Number of faces that are tried; those that look aside are left out.
        size: Side of the chart in texels.
        seed: Seed of the faces.
        ict: File of ICT-FaceKit; None: all heads are procedural.
        geometry: Folder of the heads.

    Raises:
        InputError: None of the faces looks straight ahead.
    """
    clips = Clips(count, ClipSettings(1.0, size=256), seed, ict=ict, geometry=geometry)
    data = clips.make_faces()
    renderers = [clips.make_renderer(data, clips.plan(number)) for number in range(count)]
    places = [normalise_landmarks(each.landmarks) for each in renderers]
    asymmetry = np.array([_measure_asymmetry(each) for each in places])
    if not (asymmetry < _FRONTAL).any():
        raise InputError(f"None of the {count} faces looks straight ahead; give more of them.")
    chosen = np.flatnonzero(asymmetry < _FRONTAL)
    landmarks = _make_symmetric(np.mean([places[index] for index in chosen], 0))
    used = [renderers[index] for index in np.flatnonzero(asymmetry < _TURNED)]
    maps = [_lay_out(each, landmarks, size) for each in used]
    seen = np.stack([each for _, each in maps])
    known = np.isfinite(seen)
    angles = np.where(known, seen, 0).sum(0) / np.where(known.any(0), known.sum(0), np.nan)
    return ChartedFaces(landmarks, np.stack([each for each, _ in maps]), angles)


def _lay_out(
    renderer: ClipRenderer, landmarks: Float[np.ndarray, "478 2"], size: int
) -> tuple[Float[np.ndarray, "size size"], Float[np.ndarray, "size size 2"]]:
    """Hemoglobin at rest and angles of a face on the chart."""
    resting = renderer.true_hemoglobin(0.0) / np.exp(renderer._find_change(0.0))
    angles = np.where(np.isfinite(resting)[..., None], renderer.chart, np.nan)
    layers = [
        warp_to_chart(each, renderer.landmarks, landmarks, size).astype(np.float64)
        for each in (resting, *np.moveaxis(angles, -1, 0))
    ]
    return layers[0], np.stack(layers[1:], -1)


def _measure_asymmetry(places: Float[np.ndarray, "478 2"]) -> float:
    return float(abs(places[list(_EYES), 0].sum() - 2 * places[_NOSE, 0]))


def _make_symmetric(places: Float[np.ndarray, "478 2"]) -> Float[np.ndarray, "478 2"]:
    """The mean of landmarks and their mirror image."""
    mirrored = np.column_stack([1 - places[:, 0], places[:, 1]])
    partner = np.empty(len(places), int)
    for part in (slice(0, MESH_POINTS), slice(MESH_POINTS, len(places))):
        apart = np.linalg.norm(places[part, None] - mirrored[None, part], axis=-1)
        partner[part] = apart.argmin(1) + (part.start or 0)
    return np.asarray((places + mirrored[partner]) / 2)
