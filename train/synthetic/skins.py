"""Skins of a hybrid model as charts that heads of the twin wear.

`python -m train.synthetic.skins skinmodel/hybrid.npz -o skins.npz` draws them from a model that
`skinnet maps` and `skinnet build-model` made in the procedural face's texture space;
`examples/london.py` draws them from portraits in a frame of its own.
"""

import argparse
import sys
from collections.abc import Sequence
from functools import cache
from pathlib import Path

import numpy as np
import torch
import torch.nn.functional as F
from jaxtyping import Bool, Float
from scipy.interpolate import LinearNDInterpolator
from scipy.ndimage import binary_fill_holes, distance_transform_edt

from skinnet.appearance.hybrid import HybridModel
from skinnet.errors import InputError
from skinnet.pipeline.texture_space import embed_model
from skinnet.shape import compute_chart_angles, load_shape_model
from train.fitted import shrunk
from train.synthetic.face_painting import beard
from train.synthetic.model_skins import Skins, save_skins
from train.synthetic.scene_sampling import CHART
from train.synthetic.tensors import soft_step

Chart = Float[np.ndarray, "rows columns"]
Charts = Float[np.ndarray, "*samples rows columns"]
Place = Float[np.ndarray, "rows columns 2"]

TEXELS = 256
"""Texels a side that a model's maps are averaged to, about twice as dense as the chart."""

FEATHER = 14
"""Texels of the chart over which a skin fades towards the border of its model."""

SCALES = ((3.0, 1.0), (8.0, 0.02), (24.0, 4e-4))
"""Widths in texels of the bells that fill gaps, and their weights: the wider ones speak where the
narrower ones see nothing."""

BROAD = 24.0
"""Standard deviation in texels, a third of the face across, of what is taken for shading."""

DAMPED = 0.7
"""Share of the broad changes, and of what the mean face has already, that is taken away: portraits'
shading reads as pigment, and lies in the same places in all of them."""

FLOOR = 0.5
"""Share of the mean face's pigment that is added before logarithms are taken: a drawn face near or
below 0 would be all contrast."""

LARGEST = 0.8
"""Largest log factor, approached smoothly."""

NO_SKIN = ((0.34, 0.03, 0.23, 0.14), (0.35, 0.21, 0.31, 0.14), (0.08, -0.44, 0.12, 0.06),
           (0.0, -0.66, 0.24, 0.02))  # fmt: skip
"""Azimuth, elevation and half widths of eyes, brows, nostrils and the line between the lips."""

LIPS = (0.0, -0.668, 0.24, 0.095)


def draw_skins(
    model: HybridModel, place: Place, count: int, seed: int = 0, spread: float = 1.0
) -> Skins:
    """Charts of faces drawn from a model with `spread` times its standard deviations.

    `place` has the model's texture coordinates (u, v in [0, 1], v upwards) of each texel of the
    chart, NaN outside the face. What is no skin is filled from around, what is broad damped, and
    the border fades, so that a skin's mean over the face is 0.
    """
    if count < 1 or seed < 0 or not 0 <= spread <= 10:
        raise InputError(
            "Skins are drawn in a count of 1 or more, by a seed of 0 or more, in a spread in "
            f"[0, 10]; got {count}, {seed} and {spread}."
        )
    skin, lips = bare()
    known = _sampled(model.mask[None].astype(np.float32), place)[0]
    weight = skin * np.clip(2 * known - 1, 0, 1)
    if weight.mean() < 0.05:
        raise InputError("The model knows hardly any texel of the face; was it made elsewhere?")
    inside = binary_fill_holes(known > 0.5)
    mean = _sampled_face(model, np.zeros(len(model.statistics.variances)), place)
    floor = FLOOR * np.median(mean[:, weight > 0.5], axis=1).clip(1e-3)[:, None, None]
    usual = DAMPED * (1 - lips) * log_factors(mean, floor, weight, lips)
    charts = np.empty((2, count, *CHART), np.float16)
    for index, beta in enumerate(spread * model.sample(count, seed)):
        face = log_factors(_sampled_face(model, beta, place), floor, weight, lips)
        charts[:, index] = worn(face - usual, lips, inside)
    return Skins(*charts)


def _sampled_face(
    model: HybridModel, beta: Float[np.ndarray, "components"], place: Place
) -> Float[np.ndarray, "pigments rows columns"]:
    """Fractions of melanin and blood of a face on the chart."""
    features, share = shrunk(model.texture(beta), TEXELS)
    layers = np.stack([features[1] * share, features[0] * share, share])
    mel, blood, seen = _sampled(layers, place)
    return np.stack([mel, blood]) / np.maximum(seen, 1e-3)


def _sampled(layers: Charts, place: Place) -> Charts:
    """Layers of a texture at places in it, 0 outside."""
    grid = np.nan_to_num((2 * place - 1) * [1, -1], nan=9).astype(np.float32)
    texture = torch.from_numpy(layers)[None]
    return F.grid_sample(texture, torch.from_numpy(grid)[None], align_corners=False)[0].numpy()


def log_factors(
    fractions: Float[np.ndarray, "pigments rows columns"],
    floor: Float[np.ndarray, "pigments 1 1"],
    weight: Chart,
    lips: Chart,
) -> Float[np.ndarray, "pigments rows columns"]:
    """Logarithms over the face's median, what does not weigh filled from around."""
    typical = np.median(fractions[:, weight > 0.5], axis=1)[:, None, None]
    log = np.log((fractions + floor) / (typical + floor))
    # What is half brow or beard does not speak for the skin around.
    return filled(log, weight, weight**4 * (1 - lips))


def worn(
    log: Float[np.ndarray, "pigments rows columns"],
    lips: Chart,
    inside: Bool[np.ndarray, "rows columns"],
) -> Float[np.ndarray, "pigments rows columns"]:
    """Log factors without what is broad, of mean 0, and fading towards the border of `inside`."""
    log = log - DAMPED * blurred(log, inside * (1 - lips), BROAD)
    log = LARGEST * np.tanh(log / LARGEST)
    depth = (distance_transform_edt(np.pad(inside, 1))[1:-1, 1:-1] / FEATHER).clip(0, 1)
    border = depth**2 * (3 - 2 * depth)
    mean = (log * border).sum((1, 2)) / border.sum()
    return border * (log - mean[:, None, None])


def filled(values: Charts, weight: Chart, source: Chart) -> Charts:
    """Values where they weigh, and elsewhere what the nearest sources say."""
    around, total = np.zeros_like(values), np.zeros_like(source)
    for width, share in SCALES:
        around += share * _bell(values * source, width)
        total += share * _bell(source, width)
    return weight * values + (1 - weight) * around / np.maximum(total, 1e-9)


def blurred(values: Charts, weight: Chart, width: float) -> Charts:
    """Weighted means under a bell of that width in texels."""
    return _bell(values * weight, width) / np.maximum(_bell(weight.astype(float), width), 1e-6)


def _bell(values: Charts, width: float) -> Charts:
    # Two products are many times faster than a filter as wide as these.
    down, across = (_taps(n, width) for n in values.shape[-2:])
    return down @ values @ across


@cache
def _taps(count: int, width: float) -> Float[np.ndarray, "n n"]:
    apart = np.arange(count)[:, None] - np.arange(count)
    return np.exp(-((apart / width) ** 2) / 2) / (width * np.sqrt(2 * np.pi))


def bare() -> tuple[Chart, Chart]:
    """Where a chart has bare skin, lips among it, and where it has lips, in [0, 1]."""
    azimuth, elevation = compute_chart_angles(*CHART)
    lips = _ellipse(*LIPS)
    full = {"moustache": 1.0, "beard": 1.0, "stubble": 0.0, "beard_grain": 1.0}
    hair = beard(
        {name: torch.tensor([value]) for name, value in full.items()}, azimuth.abs(), elevation
    )
    skin = 1 - hair.reshape(*CHART).numpy() * (1 - lips)
    for place in NO_SKIN:
        skin = skin * (1 - _ellipse(*place))
    return skin, lips


def _ellipse(at: float, height: float, wide: float, tall: float) -> Chart:
    azimuth, elevation = compute_chart_angles(*CHART)
    across = (azimuth.abs() - at if at else azimuth) / wide
    return soft_step(1 - torch.hypot(across, (elevation - height) / tall), 0.2).numpy()


def procedural_place(own_uv: bool = False) -> Place:
    """Texture coordinates over the chart in the procedural face's own texture space.

    By default that is `skinnet maps`' embedding of the face; with `own_uv` it is the chart itself.
    """
    model = load_shape_model()
    space = embed_model(model, own_uv)
    place = LinearNDInterpolator(model.uv, space.uv)
    axes = (np.linspace(0, 1, n) for n in CHART[::-1])
    u, v = np.meshgrid(*axes)
    return place(u, v[::-1])


def main(argv: Sequence[str] | None = None) -> int:
    """Draw skins from a model of the procedural face; the exit code is 2 for bad input."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("model", type=Path, help="hybrid.npz of skinnet build-model")
    parser.add_argument("-o", "--output", type=Path, default=Path("skins.npz"))
    parser.add_argument("--count", type=int, default=200, help="Skins to draw.")
    parser.add_argument("--seed", type=int, default=0, help="The same seed, the same skins.")
    parser.add_argument("--spread", type=float, default=1.0, help="Standard deviations drawn.")
    parser.add_argument(
        "--own-uv", action="store_true", help="The maps were made with --warp.own_uv=true."
    )
    given = parser.parse_args(argv)
    try:
        place = procedural_place(given.own_uv)
        model = HybridModel.load(given.model)
        save_skins(given.output, draw_skins(model, place, given.count, given.seed, given.spread))
    except InputError as error:
        print(error, file=sys.stderr)
        return 2
    print(f"{given.output}: {given.count} skins of {given.model}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
