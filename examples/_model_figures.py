"""Figures 6, 7 and 8 of the paper, from the results of `examples.lightstage`."""

import json
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from numpy.typing import NDArray
from PIL import Image

from skinnet.appearance import HybridModel, PigmentEdit, edit_texture, load_maps
from skinnet.appearance.colour import SkinColour
from skinnet.images import resize
from skinnet.inference._tiles import draw_grid, draw_picture, draw_pigment_map
from skinnet.mesh import read_mesh
from skinnet.pipeline import RelightSettings
from skinnet.pipeline._model_figures import draw_hybrid, fill_texels
from skinnet.pipeline._model_results import make_renderer
from skinnet.pipeline.relight import TILE_SIZE
from skinnet.render import Scene

EDITS = {"hemoglobin": 2.0, "melanin": 1.5}
"""What Figure 6 multiplies, in its upper and in its lower row."""

DEVIATIONS, COMPONENTS = 2.0, 3

_MAPS = {"melanin": "f_mel", "hemoglobin": "f_blood"}

_MODELS = {"HybridModel": "hybrid, own features", "LinearModel": "linear, RGB"}
_PANELS = {
    "compactness": ("(a) compactness", "cumulative variance, %", 100.0),
    "generalisation": ("(b) generalisation", "RMS error left out, linear RGB", 1.0),
    "specificity": ("specificity, not in the paper", "RMS to the nearest person, linear RGB", 1.0),
}


def draw_edits(files: Sequence[Path], yaw: float = 20.0) -> NDArray[np.uint8]:
    """Draw a person with more hemoglobin and one with more melanin (Figure 6).

    Args:
        files: Two NAME_maps.npz of `skinnet maps`, with NAME_face.obj beside them.
        yaw: Angle in degrees from which the faces are seen.

    Returns:
        The picture, a person a row: face, map, edited map, edited face.
    """
    light = RelightSettings(size=TILE_SIZE, yaw=yaw)
    rows = [
        _draw_edit(file, pigment, factor, light)
        for file, (pigment, factor) in zip(files, EDITS.items(), strict=True)
    ]
    return draw_grid([tile for row in rows for tile in row], 4)


def _draw_edit(
    file: Path, pigment: str, factor: float, light: RelightSettings
) -> tuple[Image.Image, ...]:
    texture, calibrated = load_maps(file)
    # The calibration holds the polariser's tint; a picture for people is without it.
    colour = SkinColour(calibrated.matrix, None, calibrated.optics)
    melanin, hemoglobin = (PigmentEdit(factor if one == pigment else 1.0) for one in _MAPS)
    edited = edit_texture(texture, colour, melanin, hemoglobin)
    scene = Scene(read_mesh(file.with_name(file.name.replace("_maps.npz", "_face.obj"))))
    share = texture.mask.astype(np.float64)
    name = f"{pigment} x {factor:g}"
    faces = [
        draw_picture(caption, light.render(scene, fill_texels(one.albedo(colour), one.mask)))
        for caption, one in (("as recovered", texture), (name, edited))
    ]
    maps = [
        draw_pigment_map(pigment, getattr(one, _MAPS[pigment]), share, caption)
        for caption, one in ((pigment, texture), (name, edited))
    ]
    return faces[0], *maps, faces[1]


def draw_components(model: Path, maps: Sequence[Path]) -> NDArray[np.uint8]:
    """Draw the mean and three components of a hybrid model on the mean shape (Figure 7).

    The picture has half of the size of its tiles.
    """
    hybrid = HybridModel.load(model / "hybrid.npz")
    count = min(COMPONENTS, len(hybrid.statistics.variances))
    sheet = draw_hybrid(hybrid, DEVIATIONS, count, make_renderer(list(maps)))
    return resize(sheet, sheet.shape[1] // 2, sheet.shape[0] // 2)


def plot_measures(model: Path, dpi: int) -> NDArray[np.uint8]:
    """Plot the measures of the hybrid and the linear model (Figure 8)."""
    measures = json.loads((model / "measures.json").read_text(encoding="utf-8"))["measures"]
    figure = Figure(figsize=(12.5, 3.9), dpi=dpi, layout="constrained")
    canvas = FigureCanvasAgg(figure)
    for axis, (measure, (title, label, unit)) in zip(
        figure.subplots(1, len(_PANELS)), _PANELS.items(), strict=True
    ):
        for model_name, name in _MODELS.items():
            counts, values = _read_curve(measures[model_name][measure])
            axis.plot(counts, unit * values, ".-", label=name)
        axis.set(title=title, xlabel="number of components", ylabel=label)
        axis.set_ylim(bottom=0)
        axis.grid(alpha=0.3)
        axis.legend()
    canvas.draw()
    return np.asarray(canvas.buffer_rgba())[..., :3].copy()


def _read_curve(curve: Mapping[str, float]) -> tuple[NDArray[np.int_], NDArray[np.float64]]:
    return np.array([int(count) for count in curve]), np.array(list(curve.values()))
