"""What a photograph of skin shows, in logarithms: chromaticity, brightness, and their noise."""

from collections.abc import Mapping
from concurrent.futures import Executor
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from skinnet.images.resizing import resize
from skinnet.images.srgb import srgb_to_linear
from skinnet.inference._editing import UNTOUCHED, WHOLLY

QUANTISED = 0.0015
"""Least noise of log chromaticity at half size, from 8 bits."""

_DARKEST, _BRIGHTEST = 0.004, 0.95
"""Linear values outside which a pixel has no colour to speak of."""

_NEARBY, _HALO = 1.35, 1.5
"""Largest difference in log brightness to the skin around, and the width of that in the network's
pixels; hair, brows and nostrils are beyond."""

_QUANTILE, _IN_SIGMAS = 0.8, 1.2816
"""Quantile of a magnitude, and what it is of a normal distribution's standard deviation."""

Image = NDArray[np.float32]
Size = tuple[int, int]
"""Width and height."""


class Seen(NamedTuple):
    """The skin of a photograph in logarithms, [3, h, w]: R/G, B/G, G; `weight` [h, w] of 0 where a
    pixel shows no skin, or is too dark or bright to have a colour."""

    logs: Image
    weight: Image


def look(crop: NDArray[np.uint8], codes: Mapping[str, Image], size: Size, pool: Executor) -> Seen:
    """The crop at that size in logarithms, where it is not skin filled in from skin nearby."""
    gloss = sized(codes["specular"], size)

    def channel(index: int) -> Image:
        return sized(srgb_to_linear(crop[..., index]), size)

    linear = np.stack(list(pool.map(channel, range(3))))
    bright = linear.max(0) > _BRIGHTEST
    linear = np.maximum(linear - gloss, np.float32(_DARKEST))
    weight = soft_mask(sized(codes["mask"], size)) * ~bright
    weight *= linear[1] > 2 * _DARKEST
    logs = np.log(linear)
    logs[0] -= logs[1]
    logs[2] -= logs[1]
    return _filled(logs[[0, 2, 1]], weight, codes["mask"].shape)


def _filled(logs: Image, weight: Image, small: tuple[int, ...]) -> Seen:
    size: Size = (weight.shape[1], weight.shape[0])
    near = _near(logs, weight, (small[1], small[0]))
    ground = sized(near[2], size)
    weight = weight * (_NEARBY - np.abs(logs[2] - ground)).clip(0, 0.35) / 0.35
    near = _near(logs, weight, (small[1], small[0]))
    for log, low in zip(logs, near, strict=True):
        fill = sized(low, size)
        log -= fill
        log *= weight
        log += fill
    return Seen(logs, weight)


def _near(logs: Image, weight: Image, small: Size) -> Image:
    """Mean of the skin around each of the network's pixels, or of all skin far from any."""
    sums = [sized(log * weight, small) for log in logs]
    total = sized(weight, small)
    means = [float(one.sum() / max(total.sum(), 1e-6)) for one in sums]
    around = ndimage.gaussian_filter(total, _HALO) + 1e-3
    return np.stack(
        [
            (ndimage.gaussian_filter(one, _HALO) + 1e-3 * mean) / around
            for one, mean in zip(sums, means, strict=True)
        ]
    ).astype(np.float32)


def colour(seen: Seen, small: Size) -> Image:
    """Logarithms of R, G and B [3, h, w] at the network's size."""
    red, blue, green = (sized(log, small) for log in seen.logs)
    return np.stack([red + green, green, blue + green])


def noise_of(seen: Seen) -> Image:
    """Covariance [2, 2] of the noise of log chromaticity, from its steps between neighbours."""
    steps = np.diff(seen.logs[:2], axis=-1) / np.float32(2**0.5)
    least = QUANTISED**2 * np.array([[1, 0.5], [0.5, 1]], np.float32)
    return larger(spread(steps, seen.weight[:, 1:]), least)


def spread(values: Image, weight: Image) -> Image:
    """Robust covariance [2, 2] of values [2, h, w] over skin: freckles hardly count in a median."""
    skin = weight > 0.5
    a, b = values[0][skin], values[1][skin]
    if not a.size:
        return np.zeros((2, 2), np.float32)
    first, second, apart = (
        (np.quantile(np.abs(v), _QUANTILE) / _IN_SIGMAS) ** 2 for v in (a, b, a - b)
    )
    both = np.clip((first + second - apart) / 2, *(np.array([-0.9, 0.9]) * (first * second) ** 0.5))
    return np.array([[first, both], [both, second]], np.float32)


def larger(a: Image, b: Image) -> Image:
    """The covariance of greater total variance."""
    return np.asarray(a if np.trace(a) > np.trace(b) else b, np.float32)


def soft_mask(mask: Image) -> Image:
    """Rises from 0 to 1 between the masks between which an edit sets in, too."""
    return ((mask - np.float32(UNTOUCHED)) * np.float32(1 / (WHOLLY - UNTOUCHED))).clip(0, 1)


def sized(channel: Image, size: Size) -> Image:
    """A channel [h, w] of another size, or the same one."""
    if (channel.shape[1], channel.shape[0]) == size:
        return channel.astype(np.float32, copy=False)
    return resize(channel.astype(np.float32, copy=False), *size)
