"""Baselines of the encoder: a constant, an inverted table, and Tsumura's two directions."""

from collections.abc import Iterable, Mapping

import torch
from torch import Tensor

from benchmarks.pictures import Pictures, Pixels, render_under_daylight
from benchmarks.running_statistics import RunningStatistics
from skinnet.physics import SkinDecoder

DIRECTIONS = (
    (0.4143, 0.3570, 0.8372),
    (0.2988, 0.6838, 0.6657),
    (1.0, 1.0, 1.0),
)
"""Melanin and hemoglobin in log R, G, B (Tsumura et al. 2003), and shading."""

DARKEST = 0.5 / 255 / 12.92
"""Half of the first step of eight bits, in linear light: stands for black in a logarithm."""

MEANS = Pixels._fields[:6]


class Constant:
    """The means of training for every pixel; all of the picture is skin."""

    def __init__(self, means: Mapping[str, Tensor]) -> None:
        self.means = means

    def __call__(self, pictures: Pictures) -> Pixels:
        """Predict the means."""
        count = len(pictures.picture)
        values = [self.means[name].float() for name in MEANS]
        everywhere = torch.ones_like(pictures.skin)
        return Pixels(*(one.expand(count, *one.shape) for one in values), everywhere)


def average_skin(batches: Iterable[Pictures]) -> dict[str, Tensor]:
    """Average all pixels of skin."""
    sums, count = {name: torch.zeros((), dtype=torch.float64) for name in MEANS}, 0
    for one in batches:
        count += len(one.picture)
        for name in MEANS:
            sums[name] = sums[name] + getattr(one.truth, name).double().sum(0)
    return {name: value / count for name, value in sums.items()}


class Lookup:
    """The nearest skin in a table of colours under D65 and the mean camera.

    Exposure and shading are unknown, so that their effect on colour is read as pigment.
    """

    def __init__(self, decoder: SkinDecoder) -> None:
        self.decoder = decoder
        self.inverse = decoder.lookup.inverse(decoder.camera.matrix(decoder.camera.standard()))

    def __call__(self, pictures: Pictures) -> Pixels:
        """Predict the nearest skin."""
        assert pictures.truth.colour is not None
        found = self.inverse(pictures.truth.colour)
        albedo = render_under_daylight(found.f_mel, found.f_blood, self.decoder)
        even = torch.ones_like(found.f_mel)
        # With its offset, the table would reproduce the colour of the photograph.
        return Pixels(found.f_mel, found.f_blood, even, None, albedo, albedo, None)


class Tsumura:
    """Coordinates in log-RGB along fixed directions of the two pigments and shading.

    Coordinates have no unit. They are fitted by least squares to the truth that they are compared
    with: pigments by a line, shading by a factor. So no calibration could be better.
    """

    def __init__(self, decoder: SkinDecoder) -> None:
        self.decoder = decoder
        self.lines = {"melanin": (1.0, 0.0), "hemoglobin": (1.0, 0.0)}
        self.scale = 1.0
        self.fits = {name: RunningStatistics() for name in (*self.lines, "shading")}

    def fit(self, pictures: Pictures) -> None:
        """Add pictures to the least-squares fit."""
        truth = pictures.truth
        assert truth.shading is not None
        melanin, hemoglobin, shading = _compute_coordinates(pictures)
        self.fits["melanin"].add(melanin, truth.melanin)
        self.fits["hemoglobin"].add(hemoglobin, truth.hemoglobin)
        self.fits["shading"].add(torch.exp(-shading), truth.shading)
        self.lines = {name: self.fits[name].line for name in self.lines}
        self.scale = self.fits["shading"].scale

    def __call__(self, pictures: Pictures) -> Pixels:
        """Predict by the fitted lines."""
        *pigments, shading = _compute_coordinates(pictures)
        melanin, hemoglobin = (
            (slope * value + offset).clamp_min(0)
            for value, (slope, offset) in zip(pigments, self.lines.values(), strict=True)
        )
        diffuse = self.scale * torch.exp(-shading)
        albedo = render_under_daylight(melanin, hemoglobin, self.decoder)
        return Pixels(melanin, hemoglobin, diffuse, None, albedo, diffuse[:, None] * albedo, None)


def _compute_coordinates(pictures: Pictures) -> Tensor:
    """Compute coordinates [3, pixels] of melanin, hemoglobin and shadow."""
    colour = pictures.truth.colour
    assert colour is not None
    basis = torch.tensor(DIRECTIONS, dtype=torch.float64)
    density = -torch.log(colour.double().clamp_min(DARKEST))
    return torch.linalg.solve(basis.mT, density.mT).float()
