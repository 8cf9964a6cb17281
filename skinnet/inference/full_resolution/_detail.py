"""Pigment detail finer than the network's maps, from the photograph's chromaticity.

The network's maps are coarse, but they come with the light and the camera. The photograph's colours
are fine, but they do not determine the light. So log chromaticity is split into octaves between
half of the photograph's size and the network's size, and each octave is inverted about the
network's maps:

    (log R/G, log B/G) = J (melanin, square root of hemoglobin),

where J is the derivative of the decoder's log colours. Shading changes no chromaticity, so it
cancels. Octaves start at half of the size, because cameras and JPEG record chromaticity no finer.
"""

from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import Executor
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from skinnet.inference.full_resolution._chromaticity import (
    Image,
    LogColours,
    Size,
    choose_larger,
    estimate_covariance,
    estimate_noise,
    measure_log_colours,
    reduce_to_log_rgb,
    resize_channel,
)
from skinnet.inference.full_resolution._colour_table import ColourTable

_PRIOR_RATIO, _PRIOR_OFFSET = (0.3, 0.1), (0.02, 0.05)
"""Prior standard deviation of an octave of melanin, and of the square root of hemoglobin: ratio
times (the network's value + offset). The offset allows freckles on pale skin."""

_NOISE_WEIGHT = 1.5
"""Variances of noise at which an octave's energy is halved."""

_GRAIN_WEIGHT = 2.0
"""Variances of an octave over all skin that are taken as noise: detail that is everywhere is more
often noise of the photograph than texture of the skin."""

_SUBSAMPLING_WEIGHT, _BLOCK_WEIGHT = 2.0, 0.08
"""Shares of luma's energy that are taken as noise of chromaticity. The first applies to the
direction in which chromaticity changes where only luma has detail, because of chroma subsampling.
The second applies to all directions, because of the artefacts of JPEG's blocks."""

_ENERGY_WINDOW, _SURROUND_WINDOW = 5, 9
"""Pixels of an octave over which its energy is averaged, and that of its surroundings; the latter
is half a block of JPEG's chromaticity."""

_EPSILON = np.float32(1e-12)
_MIN_PIXELS = 64
"""Smallest number of skin pixels from which noise can be measured."""


def recover_detail(
    crop: NDArray[np.uint8], maps: Mapping[str, Image], table: ColourTable, pool: Executor
) -> tuple[Image, Image]:
    """Recover what to add to the network's melanin and hemoglobin, float32 [H / 2, W / 2].

    `crop` is uint8 sRGB [H, W, 3], `maps` are the network's maps [h, w] of it. The result is zero
    off skin, and everywhere if the crop is less than twice as large as the maps.
    """
    height, width = crop.shape[:2]
    small: Size = (maps["melanin"].shape[1], maps["melanin"].shape[0])
    sizes = list_octaves((max(width // 2, small[0]), max(height // 2, small[1])), small)
    colours = measure_log_colours(crop, maps, sizes[0], pool)
    detail = np.zeros((2, sizes[0][1], sizes[0][0]), np.float32)
    if len(sizes) > 1 and np.count_nonzero(colours.weight > 0.5) >= _MIN_PIXELS:
        inverse = _OctaveInverse(
            maps, table, reduce_to_log_rgb(colours, small), estimate_noise(colours)
        )
        for octave in _split_octaves(colours, sizes, pool):
            changes = inverse.invert(octave, colours.weight, sizes[0], pool)
            for total, change in zip(detail, changes, strict=True):
                total += resize_channel(change, sizes[0]) * colours.weight
    return _convert_to_fractions(detail, maps, sizes[0])


def list_octaves(largest: Size, smallest: Size) -> list[Size]:
    """Sizes from the largest by halves to the smallest, none within a factor 1.5 of it."""
    sizes = [largest]
    while max(sizes[-1]) > max(smallest):
        half = tuple(max(n // 2, least) for n, least in zip(sizes[-1], smallest, strict=True))
        near = max(half) < 1.5 * max(smallest)
        sizes.append(smallest if near else (half[0], half[1]))
    return sizes


class _OctaveInverse:
    """Inverts octaves of log chromaticity to octaves of pigment, and removes noise."""

    def __init__(
        self, maps: Mapping[str, Image], table: ColourTable, log_rgb: Image, noise: Image
    ) -> None:
        melanin, root = maps["melanin"], np.sqrt(maps["hemoglobin"])
        derivatives = np.stack(table.differentiate_log(melanin, maps["hemoglobin"]), -1)
        red, green, blue = (derivatives[..., channel, :] for channel in range(3))
        self._jacobian = np.stack([red - green, blue - green], -2)
        deviations = [
            ratio * (value + offset)
            for ratio, value, offset in zip(
                _PRIOR_RATIO, (melanin, root), _PRIOR_OFFSET, strict=True
            )
        ]
        self._prior = np.stack(deviations, -1)[..., None] ** 2 * np.eye(2, dtype=np.float32)
        # Luma is a sum of gamma-encoded values: an equal change of all three of them is a larger
        # change of the darker channels' logarithms.
        encoded = np.exp(log_rgb / 2.4)
        self._luma_only = np.stack([encoded[1] / encoded[0] - 1, encoded[1] / encoded[2] - 1], -1)
        self._noise = noise

    def invert(
        self, octave: Image, weight: Image, finest: Size, pool: Executor
    ) -> tuple[Image, Image]:
        """Octaves of melanin and of the root of hemoglobin from one of log colours [3, h, w]."""
        size: Size = (octave.shape[2], octave.shape[1])
        noise = self._noise * (size[0] / finest[0]) ** 2
        grain = estimate_covariance(octave[:2], resize_channel(weight, size))
        noise = choose_larger(noise, _GRAIN_WEIGHT * grain)
        transposed = np.swapaxes(self._jacobian, -1, -2)
        total = self._jacobian @ self._prior @ transposed + noise
        gains = self._prior @ transposed @ np.linalg.inv(total)
        luma = ndimage.uniform_filter(octave[2] ** 2, _SURROUND_WINDOW)

        def invert_pigment(gain: Image) -> Image:
            change = resize_channel(gain[..., 0], size) * octave[0]
            change += resize_channel(gain[..., 1], size) * octave[1]
            noise_energy = _NOISE_WEIGHT * np.einsum("...i,ij,...j->...", gain, noise, gain)
            luma_share = _SUBSAMPLING_WEIGHT * ((gain * self._luma_only).sum(-1) ** 2)
            luma_share += _BLOCK_WEIGHT * (gain**2).sum(-1)
            noise_energy = resize_channel(noise_energy, size)
            noise_energy += resize_channel(luma_share, size) * luma
            return _attenuate(change, octave[2], luma, noise_energy)

        melanin, root = pool.map(invert_pigment, (gains[..., 0, :], gains[..., 1, :]))
        return melanin, root


def _attenuate(change: Image, log: Image, luma: Image, noise_energy: Image) -> Image:
    """Weaken an octave of pigment where it is likely to be noise.

    A squared Wiener filter compares its energy with the noise's. Pigment darkens skin, so what does
    not correlate negatively with log brightness is weakened too.
    """
    squares = change**2
    energy = ndimage.uniform_filter(squares, _ENERGY_WINDOW) + _EPSILON
    surround = ndimage.uniform_filter(squares, _SURROUND_WINDOW) + _EPSILON
    covariance = ndimage.uniform_filter(change * log, _SURROUND_WINDOW)
    correlation = (-covariance / np.sqrt(surround * (luma + _EPSILON))).clip(0, 1)
    return np.asarray(change * correlation / (1 + (noise_energy / energy) ** 2), np.float32)


def _split_octaves(colours: LogColours, sizes: list[Size], pool: Executor) -> Iterator[Image]:
    current = list(colours.channels)
    for size, smaller in pairwise(sizes):
        lower = list(pool.map(_resizer(smaller), current))
        raised = pool.map(_resizer(size), lower)
        yield np.stack([one - low for one, low in zip(current, raised, strict=True)])
        current = lower


def _convert_to_fractions(
    detail: Image, maps: Mapping[str, Image], size: Size
) -> tuple[Image, Image]:
    """Changes of melanin and of the root of hemoglobin as changes of both fractions."""
    melanin = resize_channel(maps["melanin"], size)
    root = np.sqrt(resize_channel(maps["hemoglobin"], size))
    # At least a tenth of a pigment is left: skin without pigment is an artefact of the photograph.
    least = np.float32(0.1)
    change = np.maximum(detail[0], (least - 1) * melanin)
    changed = np.maximum(root + detail[1], least**0.5 * root)
    return change, changed**2 - root**2


def _resizer(size: Size) -> Callable[[Image], Image]:
    return lambda channel: resize_channel(channel, size)
