"""Pigment finer than the network sees, from a photograph's colours and the physics of skin.

What the network reads is coarse but knows the light, and a pixel's colour is fine but does not.
So log chromaticity is taken apart into octaves between half of the photograph's size and the
network's, and each is inverted about the network's maps:

    (log R/G, log B/G) = J (melanin, root of hemoglobin),    J from the decoder's colours.

Shading alone has no part in it: it changes no chromaticity. Half of the size, because cameras
and JPEG record chromaticity no finer.
"""

from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import Executor
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from skinnet.inference.full_resolution._chromaticity import (
    Image,
    Seen,
    Size,
    colour,
    larger,
    look,
    noise_of,
    sized,
    spread,
)
from skinnet.inference.full_resolution._colour_table import ColourTable

SPREAD = (0.3, 0.1)
"""Standard deviation of an octave of melanin and of the root of hemoglobin, relative to the
network's value plus ROOM: pale skin has freckles too."""
ROOM = (0.02, 0.05)

NOISE = 1.5
"""Variances of noise at which an octave's energy counts half."""

TYPICAL = 2.0
"""Variances of an octave over skin that count as noise: what is seen everywhere is the grain of
the picture more often than that of the skin."""

UNRECORDED, ASTRAY = 2.0, 0.08
"""Energies of luma that count as noise of chromaticity: along the change that a photograph shows
where only its luma has detail, and in all directions, for what JPEG's blocks spread around it."""

_NEAR, _AROUND = 5, 9
"""Pixels of an octave over which energy is looked at, and of its surroundings, half a block of
JPEG's chromaticity."""

_TINY = np.float32(1e-12)
_FEWEST = 64
"""Pixels of skin without which there is nothing to measure noise on."""


def pigment_detail(
    crop: NDArray[np.uint8], codes: Mapping[str, Image], table: ColourTable, pool: Executor
) -> tuple[Image, Image]:
    """What to add to the network's melanin and hemoglobin, float32 [H / 2, W / 2].

    `crop` is uint8 sRGB [H, W, 3], `codes` the network's maps [h, w] of it. Zero outside skin, and
    everywhere where the photograph is less than twice as large as what the network saw.
    """
    height, width = crop.shape[:2]
    small: Size = (codes["melanin"].shape[1], codes["melanin"].shape[0])
    sizes = octaves((max(width // 2, small[0]), max(height // 2, small[1])), small)
    seen = look(crop, codes, sizes[0], pool)
    detail = np.zeros((2, sizes[0][1], sizes[0][0]), np.float32)
    if len(sizes) > 1 and np.count_nonzero(seen.weight > 0.5) >= _FEWEST:
        inverse = _Inverse(codes, table, colour(seen, small), noise_of(seen))
        for octave in _bands(seen, sizes, pool):
            change = inverse(octave, seen.weight, sizes[0], pool)
            for total, part in zip(detail, change, strict=True):
                total += sized(part, sizes[0]) * seen.weight
    return _as_fractions(detail, codes, sizes[0])


def octaves(largest: Size, smallest: Size) -> list[Size]:
    """Sizes from the largest by halves to the smallest, none within a factor 1.5 of it."""
    sizes = [largest]
    while max(sizes[-1]) > max(smallest):
        half = tuple(max(n // 2, least) for n, least in zip(sizes[-1], smallest, strict=True))
        near = max(half) < 1.5 * max(smallest)
        sizes.append(smallest if near else (half[0], half[1]))
    return sizes


class _Inverse:
    """Octaves of log chromaticity to octaves of pigment, with what is noise taken out."""

    def __init__(self, codes: Mapping[str, Image], table: ColourTable, colour: Image, white: Image):
        melanin, root = codes["melanin"], np.sqrt(codes["hemoglobin"])
        slopes = np.stack(table.slopes(melanin, codes["hemoglobin"]), -1)
        self._slopes = np.stack(
            [slopes[..., 0, :] - slopes[..., 1, :], slopes[..., 2, :] - slopes[..., 1, :]], -2
        )
        spread = [s * (f + r) for s, f, r in zip(SPREAD, (melanin, root), ROOM, strict=True)]
        self._prior = np.stack(spread, -1)[..., None] ** 2 * np.eye(2, dtype=np.float32)
        # Luma is a sum of values with a display's curve: what is added to all three of them alike
        # changes the darker channels' logarithms more.
        display = np.exp(colour / 2.4)
        self._unrecorded = np.stack([display[1] / display[0] - 1, display[1] / display[2] - 1], -1)
        self._white = white

    def __call__(self, octave: Image, weight: Image, finest: Size, pool: Executor) -> list[Image]:
        size: Size = (octave.shape[2], octave.shape[1])
        noise = self._white * (size[0] / finest[0]) ** 2
        noise = larger(noise, TYPICAL * spread(octave[:2], sized(weight, size)))
        turned = np.swapaxes(self._slopes, -1, -2)
        gains = self._prior @ turned @ np.linalg.inv(self._slopes @ self._prior @ turned + noise)
        luma = ndimage.uniform_filter(octave[2] ** 2, _AROUND)

        def pigment(gain: Image) -> Image:
            change = sized(gain[..., 0], size) * octave[0]
            change += sized(gain[..., 1], size) * octave[1]
            grain = NOISE * np.einsum("...i,ij,...j->...", gain, noise, gain)
            leak = UNRECORDED * ((gain * self._unrecorded).sum(-1) ** 2)
            leak += ASTRAY * (gain**2).sum(-1)
            doubt = sized(grain, size) + sized(leak, size) * luma
            return _believed(change, octave[2], luma, doubt)

        return list(pool.map(pigment, (gains[..., 0, :], gains[..., 1, :])))


def _believed(change: Image, log: Image, luma: Image, doubt: Image) -> Image:
    """An octave of pigment, less where its energy is not above what is in doubt (Wiener's rule,
    squared), and less where brightness does not fall with it, as pigment makes it fall."""
    squares = change**2
    near = ndimage.uniform_filter(squares, _NEAR) + _TINY
    around = ndimage.uniform_filter(squares, _AROUND) + _TINY
    together = ndimage.uniform_filter(change * log, _AROUND)
    agreement = (-together / np.sqrt(around * (luma + _TINY))).clip(0, 1)
    return np.asarray(change * agreement / (1 + (doubt / near) ** 2), np.float32)


def _bands(seen: Seen, sizes: list[Size], pool: Executor) -> Iterator[Image]:
    current = list(seen.logs)
    for size, smaller in pairwise(sizes):
        lower = list(pool.map(_resizer(smaller), current))
        raised = pool.map(_resizer(size), lower)
        yield np.stack([one - low for one, low in zip(current, raised, strict=True)])
        current = lower


def _as_fractions(detail: Image, codes: Mapping[str, Image], size: Size) -> tuple[Image, Image]:
    """Differences of melanin and of the root of hemoglobin to those of both fractions."""
    melanin = sized(codes["melanin"], size)
    root = np.sqrt(sized(codes["hemoglobin"], size))
    # At least a tenth is left of a pigment, for a spot without any is a fault of the picture.
    least = np.float32(0.1)
    change = np.maximum(detail[0], (least - 1) * melanin)
    raised = np.maximum(root + detail[1], least**0.5 * root)
    return change, raised**2 - root**2


def _resizer(size: Size) -> Callable[[Image], Image]:
    return lambda channel: sized(channel, size)
