"""Figures of appearance models, like Figures 7 and 8 of Alotaibi & Smith 2017."""

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path

import numpy as np
from jaxtyping import Bool, Float, Float32, Int, UInt8
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator
from PIL import Image
from scipy import ndimage

from skinnet.appearance._curves import Curve
from skinnet.appearance._model import AppearanceModel
from skinnet.appearance.hybrid import HybridModel
from skinnet.appearance.linear import LinearModel
from skinnet.appearance.measures import Measures
from skinnet.errors import InputError
from skinnet.files import write_atomically
from skinnet.images.srgb import linear_to_srgb, to_uint8
from skinnet.inference._tiles import (
    BLANK,
    draw_grid,
    draw_picture,
    draw_pigment_map,
)

AlbedoRenderer = Callable[[Float32[np.ndarray, "size size 3"]], UInt8[np.ndarray, "height width 3"]]
"""Renders a linear RGB albedo as uint8 sRGB, on the mean shape for instance."""

Line = tuple[Int[np.ndarray, "counts"], Float[np.ndarray, "counts"]]


def plot_measures(
    path: Path, measures: Sequence[Measures], text: Mapping[str, str] | None = None
) -> None:
    """Plot compactness, generalisation and specificity of models to a PNG file.

    For a joint model the measures of shape, in mm, are added. `text` goes into tEXt chunks.

    Source:
        Figure 8 of Alotaibi & Smith 2017.
    """
    shapes = any(one.shape_generalisation is not None for one in measures)
    figure = Figure(figsize=(15.5 if shapes else 10.5, 8.4), layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.subplots(2, 3 if shapes else 2)
    share = "cumulative variance, %"
    _plot(axes[0, 0], measures, _own_compactness, "(a) compactness in own features", share)
    _plot(axes[0, 1], measures, _colour_compactness, "(b) compactness in linear RGB", share)
    error, distance = "RMS error left out", "RMS to the nearest subject"
    for axis, field, title, label in (
        (axes[1, 0], "generalisation", "(c) generalisation", f"{error}, linear RGB"),
        (axes[1, 1], "specificity", "(d) specificity", f"{distance}, linear RGB"),
        (axes[0, -1], "shape_generalisation", "(e) generalisation of shape", f"{error}, mm"),
        (axes[1, -1], "shape_specificity", "(f) specificity of shape", f"{distance}, mm"),
    )[: 4 if shapes else 2]:
        _plot(axis, measures, partial(_mean_curve, field), title, label)
    with write_atomically(path) as part:
        figure.savefig(part, format="png", dpi=110, metadata=dict(text or {}))


def _own_compactness(measures: Measures) -> Line:
    return np.arange(1, len(measures.compactness) + 1), 100 * measures.compactness


def _colour_compactness(measures: Measures) -> Line:
    curve = measures.colour_compactness
    return curve.counts, 100 * curve.mean


def _mean_curve(field: str, measures: Measures) -> Line | None:
    curve: Curve | None = getattr(measures, field)
    return None if curve is None else (curve.counts, curve.mean)


def _plot(
    axis: Axes,
    measures: Sequence[Measures],
    line: Callable[[Measures], Line | None],
    title: str,
    label: str,
) -> None:
    for index, one in enumerate(measures):
        if (points := line(one)) is not None:
            axis.plot(*points, f"C{index}.-", label=one.name)
    axis.set(title=title, xlabel="number of components", ylabel=label)
    axis.set_ylim(bottom=0)
    axis.xaxis.set_major_locator(MaxNLocator(integer=True))
    axis.grid(alpha=0.3)
    axis.legend()


def draw_hybrid(
    model: HybridModel,
    deviations: float = 3.0,
    components: int = 3,
    renderer: AlbedoRenderer | None = None,
) -> UInt8[np.ndarray, "height width 3"]:
    """Draw the mean and the first components at -/+ some deviations, uint8 sRGB.

    The rows are melanin, hemoglobin, and the appearance, rendered or as a texture.

    Source:
        Figure 7 of Alotaibi & Smith 2017.
    """
    captions, betas = _choose_extreme_faces(model, deviations, components)
    textures = [model.texture(beta) for beta in betas]
    melanin = _draw_pigment("melanin", captions, [face.f_mel for face in textures], model.mask)
    blood = _draw_pigment("hemoglobin", captions, [face.f_blood for face in textures], model.mask)
    return draw_grid(
        [*melanin, *blood, *_draw_appearances(model, captions, betas, renderer)], len(betas)
    )


def draw_linear(
    model: LinearModel,
    deviations: float = 3.0,
    components: int = 3,
    renderer: AlbedoRenderer | None = None,
) -> UInt8[np.ndarray, "height width 3"]:
    """Draw the mean and the first components of a linear model, uint8 sRGB."""
    captions, betas = _choose_extreme_faces(model, deviations, components)
    return draw_grid(_draw_appearances(model, captions, betas, renderer), len(betas))


def _choose_extreme_faces(
    model: AppearanceModel, deviations: float, components: int
) -> tuple[list[str], list[Float[np.ndarray, "components"]]]:
    most = len(model.statistics.variances)
    if not 1 <= components <= most:
        raise InputError(f"The model has {most} components; {components} cannot be drawn.")
    captions, betas = ["mean"], [np.zeros(most)]
    for index in range(components):
        for sign in (-1, 1):
            beta = np.zeros(most)
            beta[index] = sign * deviations * np.sqrt(model.statistics.variances[index])
            betas.append(beta)
            captions.append(f"component {index + 1}, {sign * deviations:+g} sd")
    return captions, betas


def _draw_pigment(
    name: str,
    captions: Sequence[str],
    maps: Sequence[Float32[np.ndarray, "size size"]],
    mask: Bool[np.ndarray, "size size"],
) -> list[Image.Image]:
    """Draw tiles of one pigment."""
    share = mask.astype(np.float64)
    return [
        draw_pigment_map(name, values, share, caption)
        for caption, values in zip(captions, maps, strict=True)
    ]


def _draw_appearances(
    model: AppearanceModel,
    captions: Sequence[str],
    betas: Sequence[Float[np.ndarray, "components"]],
    renderer: AlbedoRenderer | None,
) -> list[Image.Image]:
    pictures = []
    for caption, beta in zip(captions, betas, strict=True):
        albedo = model.reconstruct(beta)
        picture = (
            renderer(fill_texels(albedo, model.mask))
            if renderer
            else _draw_texture(albedo, model.mask)
        )
        pictures.append(draw_picture(caption, picture))
    return pictures


def fill_texels(
    albedo: Float32[np.ndarray, "size size 3"], mask: Bool[np.ndarray, "size size"]
) -> Float32[np.ndarray, "size size 3"]:
    """Give texels that are not modelled the colour of the nearest one that is, to render them."""
    nearest: Int[np.ndarray, "2 size size"] = ndimage.distance_transform_edt(
        ~mask, return_distances=False, return_indices=True
    )
    filled: Float32[np.ndarray, "size size 3"] = albedo[tuple(nearest)]
    return filled


def _draw_texture(
    albedo: Float32[np.ndarray, "size size 3"], mask: Bool[np.ndarray, "size size"]
) -> UInt8[np.ndarray, "size size 3"]:
    blank = np.array(BLANK, np.uint8)
    return np.where(mask[..., None], to_uint8(linear_to_srgb(albedo)), blank)
