"""The colours of a face at rest, and those of frames beside them."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from skinnet.video._frame_colours import BRIGHTEST, DARKEST

_LEAST_TEXELS = 12
_LEAST_SHARE = 0.4
"""Least part of a region's skin at rest that is seen in a frame for it to be read."""

_MOST_CHROMA = 0.5
"""Largest change of a texel's log chroma that is skin: hair, a hand or glasses before it change it
beyond any blood."""

Array = NDArray[np.float64]
Colours = NDArray[np.float32]


class ComparedFrame(NamedTuple):
    """A frame beside the baseline.

    Attributes:
        ratios: Log ratios of the regions' linear RGB, [regions, 3]; NaN if hidden.
        texels: Log ratios of the texels, [texels, 3].
        seen: Which texels are seen, [texels].
    """

    ratios: Array
    texels: Colours
    seen: NDArray[np.bool_]


class Baseline:
    """The mean colours of the frames of a baseline, whose exposure may have changed.

    Args:
        frames: Linear RGB of one or more frames, [texels, 3] each; NaN for what is not seen.
        skin: Which texels are skin, [texels].
        regions: Texels of each region, bool [regions, texels].

    Attributes:
        colours: Linear RGB, [texels, 3].
        usable: Which texels are skin and neither black nor burnt out, [texels].
        regions: The usable texels of each region, bool [regions, texels].
        levels: Mean linear RGB of the regions, [regions, 3].
    """

    def __init__(
        self, frames: list[Colours], skin: NDArray[np.bool_], regions: NDArray[np.bool_]
    ) -> None:
        stack = np.stack(frames)
        level = np.nanmedian(np.nanmean(stack, 2), 1)[:, None, None]
        base = np.nanmean(stack * (np.median(level) / level), 0)
        self.colours: Colours = base.astype(np.float32)
        usable = skin & np.isfinite(base).all(1)
        self.usable = usable & (base.max(1) < BRIGHTEST) & (base.min(1) > DARKEST)
        self.regions = regions & self.usable
        self._areas = self.regions.sum(1)
        lit = self.regions @ np.where(self.usable[:, None], base, 0).astype(np.float64)
        self.levels: Array = lit / np.maximum(self._areas, 1)[:, None]

    def compare(self, colours: Colours) -> ComparedFrame:
        """Compare the colours of a frame, linear RGB [texels, 3], with the baseline."""
        with np.errstate(divide="ignore", invalid="ignore"):
            texels = np.log(colours / self.colours)
        seen = self._find_seen(colours, texels)
        return ComparedFrame(self._average(colours, seen), texels, seen)

    def _find_seen(self, colours: Colours, texels: Colours) -> NDArray[np.bool_]:
        seen = np.isfinite(colours).all(1) & (colours.max(1) < BRIGHTEST) & (colours.min(1) > 0)
        known, own = seen & self.usable, texels
        if known.any():
            own = texels - np.nanmedian(texels[known], 0, keepdims=True)
        chroma = np.abs(own[:, [0, 2]] - own[:, 1:2]).max(1)
        return np.asarray(seen & (chroma < _MOST_CHROMA))

    def _average(self, colours: Colours, seen: NDArray[np.bool_]) -> Array:
        """Log ratios of the regions' means over the texels that are seen."""
        masks = (self.regions & seen).astype(np.float32)
        lit, base = (masks @ np.where(seen[:, None], each, 0) for each in (colours, self.colours))
        count = masks.sum(1)
        enough = (count >= _LEAST_TEXELS) & (count >= _LEAST_SHARE * self._areas)
        with np.errstate(divide="ignore", invalid="ignore"):
            ratios = np.log(lit.astype(np.float64)) - np.log(base.astype(np.float64))
        ratios[~enough] = np.nan
        return np.asarray(ratios)
