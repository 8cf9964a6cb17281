"""Whether a reading follows when only the pigment of a photograph is changed."""

from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import NamedTuple

import numpy as np
import torch
from numpy.typing import NDArray

from benchmarks.portraits import PIGMENTS
from benchmarks.reader import NetworkReader
from benchmarks.report import Results
from benchmarks.skin_readings import read_skin
from skinnet.images import read_picture
from skinnet.images.srgb import LUMINANCE_WEIGHTS, linear_to_srgb, srgb_to_linear, to_uint8
from skinnet.inference._editing import apply_change, compute_change
from skinnet.network.autoencoder import SkinMaps
from skinnet.physics import Capture
from train.edited_skin import multiply_pigments

FACTORS = (0.5, 0.5**0.5, 2**0.5, 2.0)
"""Factors on a pigment, whose logarithms are symmetric about zero."""

Photograph = NDArray[np.uint8]


class KnownCrop(NamedTuple):
    """A crop of a face, and what is known of its capture."""

    crop: Photograph
    known: Capture | None = None


class PigmentEditor:
    """Multiplies the pigments of the skin in a crop as `Decomposer.edit` does.

    Args:
        crop: A crop of a face.
        network: Whose reading and colours are used.
    """

    def __init__(self, crop: Photograph, network: NetworkReader) -> None:
        self.crop, self.decoder = crop, network.model.decoder
        self.maps, capture, _ = network.read(crop)
        self.matrix = self.decoder.camera.matrix(capture)
        self.before = self._render(self.maps)

    def __call__(self, factors: Mapping[str, float]) -> Photograph:
        """Multiply pigments by factors; one that is not named stays."""
        maps = self.maps
        logs = torch.tensor([[factors.get(name, 1.0) for name in PIGMENTS]]).log()
        changed = multiply_pigments(maps, logs)
        picture = read_picture(self.crop)
        picture = replace(picture, pixels=picture.pixels.copy())
        mask = maps.mask[0].numpy()
        change = compute_change(self.before, self._render(changed), mask)
        apply_change(picture, change, maps.specular[0].numpy(), mask)
        return picture.srgb

    @torch.no_grad()
    def _render(self, maps: SkinMaps) -> NDArray[np.float32]:
        albedo = self.decoder.albedo(maps.melanin, maps.hemoglobin, self.matrix)
        return albedo[0].movedim(0, -1).clamp(0, 1).numpy()


def measure_slopes(
    crops: Iterable[KnownCrop], reader: NetworkReader, editor: NetworkReader
) -> Results:
    """Measure slopes of the log reading on the log factor; the surroundings stay.

    Args:
        crops: Faces.
        reader: The network that reads, given what is known.
        editor: The network whose colours change the pigment.

    Returns:
        The mean slope over faces of each pigment; 1 follows fully, 0 not at all.
    """
    slopes: dict[str, list[float]] = {name: [] for name in PIGMENTS}
    for crop, known in crops:
        edit = PigmentEditor(crop, editor)
        for index, name in enumerate(PIGMENTS):
            edited = [edit({name: factor}) for factor in FACTORS]
            read = [read_skin(reader, one, known=known).pigments[index] for one in edited]
            slopes[name].append(fit_slope(read))
    return {name: average(some) for name, some in slopes.items()}


def fit_slope(read: Iterable[float], factors: Iterable[float] = FACTORS) -> float:
    """Least-squares slope of log readings on the logarithms of factors."""
    x, y = np.log(np.array(list(factors))), np.array(list(read))
    x, y = x - x.mean(), y - y.mean()
    return float(x @ y / (x @ x))


def average(values: Iterable[float]) -> float | None:
    """Mean of the finite values; None without any."""
    finite = [value for value in values if np.isfinite(value)]
    return float(np.mean(finite)) if finite else None


def remove_colour(crop: Photograph) -> Photograph:
    """Replace each pixel by its luminance in all three channels."""
    light = srgb_to_linear(crop) @ LUMINANCE_WEIGHTS
    return np.repeat(to_uint8(linear_to_srgb(light))[..., None], 3, -1)
