"""Log colours of the skin in a photograph: chromaticity, brightness, and their noise."""

from collections.abc import Mapping
from concurrent.futures import Executor
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from skinnet.images.resizing import resize
from skinnet.images.srgb import srgb_to_linear
from skinnet.inference._editing import soften_mask

_QUANTISATION_NOISE = 0.0015
"""Least standard deviation of log chromaticity at half size, from 8 bits."""

_MIN_LINEAR, _MAX_LINEAR = 0.004, 0.95
"""Linear values outside which a channel is too noisy or saturated to have a chromaticity."""

_MAX_CONTRAST, _CONTRAST_RAMP = 1.35, 0.35
"""Difference in log brightness to the skin nearby at which a pixel is not skin (hair, brows and
nostrils exceed it), and the width over which its weight falls to 0."""

_NEARBY = 1.5
"""Standard deviation, in pixels of the network, of the Gaussian that averages skin nearby."""

_QUANTILE, _QUANTILE_IN_SIGMAS = 0.8, 1.2816
"""A quantile of magnitudes, and its value for a standard normal distribution."""

Image = NDArray[np.float32]
Size = tuple[int, int]
"""Width and height."""


class LogColours(NamedTuple):
    """Log colours of skin, filled in elsewhere with those of skin nearby.

    `channels` [3, h, w] are log R/G, log B/G and log G. `weight` [h, w] is 0 where a pixel is no
    skin, or too dark or too bright to have a chromaticity.
    """

    channels: Image
    weight: Image


def measure_log_colours(
    crop: NDArray[np.uint8], maps: Mapping[str, Image], size: Size, pool: Executor
) -> LogColours:
    """Log colours of uint8 sRGB [H, W, 3] at another size, without specular reflection."""
    specular = resize_channel(maps["specular"], size)

    def linearise(index: int) -> Image:
        return resize_channel(srgb_to_linear(crop[..., index]), size)

    linear = np.stack(list(pool.map(linearise, range(3))))
    saturated = linear.max(0) > _MAX_LINEAR
    linear = np.maximum(linear - specular, np.float32(_MIN_LINEAR))
    weight = soften_mask(resize_channel(maps["mask"], size)) * ~saturated
    weight *= linear[1] > 2 * _MIN_LINEAR
    logs = np.log(linear)
    logs[0] -= logs[1]
    logs[2] -= logs[1]
    height, width = maps["melanin"].shape
    return _fill_off_skin(logs[[0, 2, 1]], weight, (width, height))


def reduce_to_log_rgb(colours: LogColours, size: Size) -> Image:
    """Log R, G and B [3, h, w] at another size."""
    red, blue, green = (resize_channel(channel, size) for channel in colours.channels)
    return np.stack([red + green, green, blue + green])


def estimate_noise(colours: LogColours) -> Image:
    """Covariance [2, 2] of the noise of log chromaticity, from differences of neighbours."""
    differences = np.diff(colours.channels[:2], axis=-1) / np.float32(2**0.5)
    least = _QUANTISATION_NOISE**2 * np.array([[1, 0.5], [0.5, 1]], np.float32)
    return choose_larger(estimate_covariance(differences, colours.weight[:, 1:]), least)


def estimate_covariance(values: Image, weight: Image) -> Image:
    """Robust covariance [2, 2] of values [2, h, w] over skin.

    Variances come from a quantile of the magnitudes, so that freckles hardly change them.
    """
    skin = weight > 0.5
    a, b = values[0][skin], values[1][skin]
    if not a.size:
        return np.zeros((2, 2), np.float32)
    first, second, difference = (
        (np.quantile(np.abs(v), _QUANTILE) / _QUANTILE_IN_SIGMAS) ** 2 for v in (a, b, a - b)
    )
    limits = np.array([-0.9, 0.9]) * (first * second) ** 0.5
    both = np.clip((first + second - difference) / 2, *limits)
    return np.array([[first, both], [both, second]], np.float32)


def choose_larger(a: Image, b: Image) -> Image:
    """The covariance of greater total variance."""
    return np.asarray(a if np.trace(a) > np.trace(b) else b, np.float32)


def resize_channel(channel: Image, size: Size) -> Image:
    """A channel [h, w] at another size; the same array if it has that size already."""
    if (channel.shape[1], channel.shape[0]) == size:
        return channel.astype(np.float32, copy=False)
    return resize(channel.astype(np.float32, copy=False), *size)


def _fill_off_skin(channels: Image, weight: Image, small: Size) -> LogColours:
    """Replace what is not skin by the mean of skin nearby; works in place on `channels`."""
    size: Size = (weight.shape[1], weight.shape[0])
    nearby = _average_nearby(channels, weight, small)
    contrast = np.abs(channels[2] - resize_channel(nearby[2], size))
    weight = weight * (_MAX_CONTRAST - contrast).clip(0, _CONTRAST_RAMP) / _CONTRAST_RAMP
    nearby = _average_nearby(channels, weight, small)
    for channel, mean in zip(channels, nearby, strict=True):
        fill = resize_channel(mean, size)
        channel -= fill
        channel *= weight
        channel += fill
    return LogColours(channels, weight)


def _average_nearby(channels: Image, weight: Image, small: Size) -> Image:
    """Mean of the skin around each of the network's pixels, or of all skin if none is near."""
    sums = [resize_channel(channel * weight, small) for channel in channels]
    total = resize_channel(weight, small)
    means = [float(one.sum() / max(total.sum(), 1e-6)) for one in sums]
    around = ndimage.gaussian_filter(total, _NEARBY) + 1e-3
    return np.stack(
        [
            (ndimage.gaussian_filter(one, _NEARBY) + 1e-3 * mean) / around
            for one, mean in zip(sums, means, strict=True)
        ]
    ).astype(np.float32)
