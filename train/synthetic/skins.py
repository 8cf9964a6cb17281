"""Samples skins of a hybrid model as charts for synthetic faces.

`python -m train.synthetic.skins skinmodel/hybrid.npz -o skins.npz` samples them from a model that
`skinnet maps` and `skinnet build-model` made in the procedural face's texture space.
`examples/london.py` samples them from portraits in a frame of its own.
"""

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import torch
import torch.nn.functional as F
from jaxtyping import Float
from scipy.interpolate import LinearNDInterpolator
from scipy.ndimage import binary_fill_holes

from skinnet.appearance.hybrid import HybridModel
from skinnet.errors import InputError
from skinnet.pipeline import embed_model
from skinnet.shape import load_shape_model
from train.fitted_scenes import average_texels
from train.synthetic.sampling.model_skins import ModelSkins, save_model_skins
from train.synthetic.sampling.skin_charts import (
    DAMPING,
    Charts,
    PigmentCharts,
    compute_log_factors,
    fade_to_border,
    find_bare_skin,
)
from train.synthetic.scene import CHART_SIZE

ChartPlaces = Float[np.ndarray, "rows columns 2"]
"""Texture coordinates (u, v in [0, 1], v upwards) of each texel of a chart; NaN is outside."""

_TEXELS = 256
"""Side in texels to which a model's maps are averaged, about twice as dense as the chart."""

_FLOOR = 0.5
"""Share of the mean face's pigment that is added before logarithms are taken. Without it
a sampled face with hardly any pigment would have extreme log factors."""


def sample_model_skins(
    model: HybridModel, places: ChartPlaces, count: int, seed: int = 0, spread: float = 1.0
) -> ModelSkins:
    """Sample faces of a model as skins.

    What is not skin is filled from around it, broad changes are damped, and the border fades, so
    that the mean over a face is 0.

    Args:
        model: The hybrid model.
        places: Where each texel of the chart lies in the model's texture space.
        count: Number of skins, 1 or more.
        seed: Seed of the samples, 0 or more.
        spread: Standard deviations that are sampled, in [0, 10].

    Returns:
        The skins.

    Raises:
        InputError: For numbers out of range, or a model that does not cover the face.
    """
    if count < 1 or seed < 0 or not 0 <= spread <= 10:
        raise InputError(
            "Skins need a count of 1 or more, a seed of 0 or more and a spread in [0, 10]; got "
            f"{count}, {seed} and {spread}."
        )
    skin, lips = find_bare_skin()
    known = _sample_texture(model.mask[None].astype(np.float32), places)[0]
    weight = skin * np.clip(2 * known - 1, 0, 1)
    if weight.mean() < 0.05:
        raise InputError(
            "The model covers hardly any texel of the face; was it made in another texture space?"
        )
    inside = binary_fill_holes(known > 0.5)
    mean = _sample_fractions(model, np.zeros(len(model.statistics.variances)), places)
    floor = _FLOOR * np.median(mean[:, weight > 0.5], axis=1).clip(1e-3)[:, None, None]
    usual = DAMPING * (1 - lips) * compute_log_factors(mean, floor, weight, lips)
    charts = np.empty((2, count, *CHART_SIZE), np.float16)
    for index, beta in enumerate(spread * model.sample(count, seed)):
        fractions = _sample_fractions(model, beta, places)
        face = compute_log_factors(fractions, floor, weight, lips)
        charts[:, index] = fade_to_border(face - usual, lips, inside)
    return ModelSkins(*charts)


def _sample_fractions(
    model: HybridModel, beta: Float[np.ndarray, "components"], places: ChartPlaces
) -> PigmentCharts:
    """Fractions of melanin and hemoglobin of a face on the chart."""
    features, share = average_texels(model.texture(beta), _TEXELS)
    layers = np.stack([features[1] * share, features[0] * share, share])
    melanin, hemoglobin, known = _sample_texture(layers, places)
    return np.asarray(np.stack([melanin, hemoglobin]) / np.maximum(known, 1e-3))


def _sample_texture(layers: Charts, places: ChartPlaces) -> Charts:
    """Layers of a texture at places in it, 0 outside."""
    grid = np.nan_to_num((2 * places - 1) * [1, -1], nan=9).astype(np.float32)
    texture = torch.from_numpy(layers)[None]
    values = F.grid_sample(texture, torch.from_numpy(grid)[None], align_corners=False)
    return np.asarray(values[0].numpy())


def find_procedural_places(own_uv: bool = False) -> ChartPlaces:
    """Find the chart's texels in the texture space of the procedural face.

    Args:
        own_uv: Whether the texture space is the chart itself instead of the embedding of
            `skinnet maps`.

    Returns:
        Their texture coordinates.
    """
    model = load_shape_model()
    space = embed_model(model, own_uv)
    assert model.uv is not None and space.uv is not None  # The shipped model has both.
    interpolate = LinearNDInterpolator(model.uv, space.uv)
    axes = (np.linspace(0, 1, n) for n in CHART_SIZE[::-1])
    u, v = np.meshgrid(*axes)
    return np.asarray(interpolate(u, v[::-1]))


def main(argv: Sequence[str] | None = None) -> int:
    """Sample skins from a model of the procedural face.

    Args:
        argv: Arguments of the command; None means those of the process.

    Returns:
        The exit code, 2 for bad input.
    """
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("model", type=Path, help="hybrid.npz of skinnet build-model")
    parser.add_argument("-o", "--output", type=Path, default=Path("skins.npz"))
    parser.add_argument("--count", type=int, default=200, help="Number of skins.")
    parser.add_argument("--seed", type=int, default=0, help="The same seed gives the same skins.")
    parser.add_argument("--spread", type=float, default=1.0, help="Standard deviations sampled.")
    parser.add_argument(
        "--own-uv", action="store_true", help="The maps were made with --warp.own_uv=true."
    )
    given = parser.parse_args(argv)
    try:
        places = find_procedural_places(given.own_uv)
        model = HybridModel.load(given.model)
        skins = sample_model_skins(model, places, given.count, given.seed, given.spread)
        save_model_skins(given.output, skins)
    except InputError as error:
        print(error, file=sys.stderr)
        return 2
    print(f"{given.output}: {given.count} skins of {given.model}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
