"""Figures 2 and 3 of the paper: spectra and colours of skin."""

from collections.abc import Sequence

import numpy as np
import torch
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from numpy.typing import NDArray

from skinnet.images import linear_to_srgb
from skinnet.physics import WAVELENGTHS, SkinReflectance, load_spectrum_to_srgb

PRESETS = {
    "paper": "the paper's tables, in consistent units",
    "measured": "fitted to measured skin",
}
"""Constants that are drawn, and what they are."""

MELANIN, BLOOD = (0.02, 0.06, 0.10), (0.02, 0.039, 0.05)
"""Fractions of Figure 2; the other pigment is at 5 % of blood in (a) and 2 % of melanin in (b)."""

MELANIN_RANGE, BLOOD_RANGE = (0.01, 0.43), (0.02, 0.07)
"""Ranges of Table 1, which Figure 3 spans."""

LIGHT, CAMERA = "LED-B3", "Nikon D200"
"""An LED for the paper's, whose spectrum is not published, and the paper's camera."""

_LINES = ("-", "--", ":")
_VIEW = {"elev": 14, "azim": -25}


def draw_spectra(dpi: int) -> NDArray[np.uint8]:
    """Draw reflectance with more melanin, and with more blood (Figure 2), a preset a row."""
    figure = _make_figure(10.5, 7.2, dpi)
    axes = figure.subplots(2, 2, sharex=True, sharey="row")
    for row, (preset, name) in zip(axes, PRESETS.items(), strict=True):
        skin = SkinReflectance(preset, dtype=torch.float64)
        more_melanin = [(f_mel, 0.05) for f_mel in MELANIN]
        more_blood = [(0.02, f_blood) for f_blood in BLOOD]
        _plot_spectra(row[0], skin, more_melanin, "melanin {0:g} %", "saddlebrown")
        _plot_spectra(row[1], skin, more_blood, "blood {1:g} %", "crimson")
        row[0].set_title(f"{preset}: (a) melanin, with 5 % of blood", loc="left")
        row[1].set_title("(b) blood, with 2 % of melanin", loc="left")
        row[0].set_ylabel(f"reflectance\n({name})")
    for axis in axes[1]:
        axis.set_xlabel("wavelength, nm")
    return _to_array(figure)


def _plot_spectra(
    axis: Axes,
    skin: SkinReflectance,
    fractions: Sequence[tuple[float, float]],
    label: str,
    colour: str,
) -> None:
    for line, pair in zip(_LINES, fractions, strict=True):
        name = label.format(*(100 * one for one in pair))
        spectrum = skin(*(torch.tensor(one, dtype=torch.float64) for one in pair)).detach()
        axis.plot(WAVELENGTHS, spectrum, line, color=colour, label=name)
    axis.set_ylim(0, None)
    axis.grid(alpha=0.3)
    axis.legend(loc="lower right")


def compute_colours(preset: str, nodes: int) -> NDArray[np.float64]:
    """Compute white-balanced linear sRGB over the ranges, [melanin, blood, 3]."""
    matrix = load_spectrum_to_srgb(LIGHT, CAMERA).double()
    f_mel = torch.from_numpy(np.geomspace(*MELANIN_RANGE, nodes))
    f_blood = torch.from_numpy(np.geomspace(*BLOOD_RANGE, nodes))
    skin = SkinReflectance(preset, dtype=torch.float64)
    return np.asarray((skin(f_mel[:, None], f_blood) @ matrix).detach())


def measure_curvature(colours: NDArray[np.float64]) -> tuple[float, float]:
    """Shares of the colours' variance that a straight line, and a plane, leave."""
    values = colours.reshape(-1, 3)
    variances = np.linalg.svd(values - values.mean(0), compute_uv=False) ** 2
    return tuple((1 - np.cumsum(variances) / variances.sum())[:2].tolist())


def draw_colours(dpi: int, nodes: int = 96) -> NDArray[np.uint8]:
    """Draw the surface of skin colours in RGB and as an image (Figure 3), a preset a row."""
    figure = _make_figure(10.5, 7.8, dpi)
    for row, preset in enumerate(PRESETS):
        colours = compute_colours(preset, nodes)
        line, plane = measure_curvature(colours)
        print(f"{preset}: a line leaves {line:.1%} of the variance, a plane {plane:.2%}")
        _plot_surface(figure, 2 * row + 1, colours, preset)
        axis = figure.add_subplot(2, 2, 2 * row + 2)
        axis.set_title("(b) the same, over both fractions", loc="left")
        _show_image(axis, colours)
    return _to_array(figure)


def _plot_surface(figure: Figure, place: int, colours: NDArray[np.float64], preset: str) -> None:
    shown = linear_to_srgb(colours.clip(0, 1).astype(np.float32))
    axis = figure.add_subplot(2, 2, place, projection="3d")
    axis.set_title(f"{preset}: (a) skin in linear RGB", loc="left")
    count = len(colours)
    options = {"rcount": count, "ccount": count, "shade": False, "antialiased": False}
    axis.plot_surface(*np.moveaxis(colours, -1, 0), facecolors=shown, linewidth=0, **options)
    axis.set(xlabel="red", ylabel="green", zlabel="blue")
    axis.view_init(**_VIEW)
    axis.set_box_aspect(None, zoom=1.15)


def _show_image(axis: Axes, colours: NDArray[np.float64]) -> None:
    axis.imshow(linear_to_srgb(colours.clip(0, 1).astype(np.float32)), aspect="auto")
    for ticks, set_ticks, limits in (
        ((1, 2, 5, 10, 20, 43), axis.set_yticks, MELANIN_RANGE),
        ((2, 3, 4, 5, 7), axis.set_xticks, BLOOD_RANGE),
    ):
        low, high = np.log(limits)
        places = (np.log(np.array(ticks) / 100) - low) / (high - low) * (len(colours) - 1)
        set_ticks(places, [str(one) for one in ticks])
    axis.set(xlabel="blood, %", ylabel="melanin, %")


def _make_figure(width: float, height: float, dpi: int) -> Figure:
    figure = Figure(figsize=(width, height), dpi=dpi, layout="constrained")
    FigureCanvasAgg(figure)
    return figure


def _to_array(figure: Figure) -> NDArray[np.uint8]:
    canvas = figure.canvas
    assert isinstance(canvas, FigureCanvasAgg)
    canvas.draw()
    return np.asarray(canvas.buffer_rgba())[..., :3].copy()
