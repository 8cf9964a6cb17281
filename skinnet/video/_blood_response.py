"""How the colours of regions answer to a change of hemoglobin, by the skin model."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from skinnet.inference.full_resolution._colour_table import ColourTable
from skinnet.video._resting_maps import RestingMaps

_RANGE, _NODES = 1.6, 65
"""Largest log change of hemoglobin that is looked for, and tabulated changes."""

_LEAST_COLOUR = 1e-4
_ROUNDS = 4

_ANSWER = 0.64, -0.0765
"""How much chroma of measured skins answers to blood, relative to the preset: the first number and
the second times the logarithm of melanin. It is .90 for light, .83 for medium and .77 for dark
skins: means over 600 skins of `SkinPrior` with their nuisance (most of it oxygenation), under
sampled lights and cameras, with a gloss of .05."""

_GAIN_SD = 2.0
"""Prior of the common log gain: exposure and shading are as good as free."""

Array = NDArray[np.float64]


class Solution(NamedTuple):
    """What is solved for each region.

    Attributes:
        change: Log ratio of hemoglobin to the baseline, [regions].
        sd: Its standard deviation by noise and gloss, [regions].
        gain: Log gain of exposure and shading, [regions].
    """

    change: Array
    sd: Array
    gain: Array


class BloodResponse:
    """Log colours of regions as functions of the log change of hemoglobin.

    log RGB changes by F(change) + gain (1, 1, 1) + gloss w. The gain stands for light, exposure and
    shading; w is the direction of white light that the surface reflects, which adds most to the
    channel that is darkest. F is the skin model at the resting maps.

    Args:
        colours: Linear RGB of bare skin under the clip's light and camera.
        rest: The resting maps.
        regions: Texels of each region, bool [regions, texels].
        factors: Factors on the resting melanin and hemoglobin, [regions, 2]; None: 1.

    Attributes:
        curves: F of each region at the nodes, [regions, nodes, 3].
        white: w of each region, relative to green, [regions, 3].
    """

    def __init__(
        self,
        colours: ColourTable,
        rest: RestingMaps,
        regions: NDArray[np.bool_],
        factors: NDArray[np.float32] | None = None,
    ) -> None:
        wanted = np.ones((len(regions), 2), np.float32) if factors is None else factors
        self.nodes = np.linspace(-_RANGE, _RANGE, _NODES)
        curves = np.stack(
            [
                _trace(colours, rest, mask, self.nodes, factor)
                for mask, factor in zip(regions, wanted, strict=True)
            ]
        )
        middle = curves[:, _NODES // 2, None]
        melanin = np.array([_average_melanin(rest, mask) for mask in regions])
        answer = (_ANSWER[0] + _ANSWER[1] * np.log(melanin))[:, None, None]
        self.curves: Array = answer * (np.log(curves) - np.log(middle))
        self._extend(colours, rest, regions)
        self.white: Array = middle[:, 0, 1:2] / middle[:, 0]

    def _extend(self, colours: ColourTable, rest: RestingMaps, regions: NDArray[np.bool_]) -> None:
        """Go on in a straight line beyond the most blood that the table has."""
        for curve, mask in zip(self.curves, regions, strict=True):
            most = np.log(colours.top[1] / float(rest.hemoglobin[_choose(rest, mask)].max()))
            last = int(np.clip(np.searchsorted(self.nodes, most) - 1, _NODES // 2 + 2, _NODES - 1))
            slope = curve[last] - curve[last - 1]
            curve[last:] = curve[last] + slope * np.arange(_NODES - last)[:, None]

    def solve(self, ratios: Array, noise: Array, gloss_sd: float | Array) -> Solution:
        """Solve for the change of each region.

        Args:
            ratios: Log ratio of the regions' linear RGB to the baseline, [regions, 3].
            noise: Its covariance, [regions, 3, 3].
            gloss_sd: Standard deviation of the change of gloss relative to green, [regions].
        """
        weights, variance = self._weigh(np.zeros(len(ratios)), noise, gloss_sd)
        change = np.zeros(len(ratios))
        for _ in range(_ROUNDS):
            value, _ = self._evaluate(change)
            whitened = np.einsum("rc,rc->r", weights, ratios - value)
            change = np.clip(change + whitened * variance, -_RANGE, _RANGE)
            weights, variance = self._weigh(change, noise, gloss_sd)
        value, _ = self._evaluate(change)
        return Solution(change, np.sqrt(variance), (ratios - value).mean(1))

    def measure_chroma(self) -> Array:
        """How much the regions' chroma answers to log hemoglobin at rest, [regions], above 0."""
        slope = self.differentiate()
        chroma = slope[:, ::2] - slope[:, 1:2]
        return np.asarray(np.maximum(np.sqrt((chroma**2).sum(1)), 1e-4))

    def differentiate(self, change: Array | float = 0.0) -> Array:
        """Derivatives of log RGB by log hemoglobin at log changes [regions], [regions, 3]."""
        return self._evaluate(np.broadcast_to(np.asarray(change, float), len(self.curves)))[1]

    def _weigh(self, change: Array, noise: Array, gloss_sd: float | Array) -> tuple[Array, Array]:
        """Rows d' C^-1 of generalised least squares [regions, 3], and posterior variances."""
        slope = self._evaluate(change)[1]
        spread = np.broadcast_to(np.asarray(gloss_sd, float), len(slope))
        white = self.white * spread[:, None]
        total = noise + _GAIN_SD**2 + white[:, :, None] * white[:, None, :]
        weights = np.linalg.solve(total, slope[..., None])[..., 0]
        information = np.maximum(np.einsum("rc,rc->r", weights, slope), 1e-9)
        return weights, 1 / information

    def _evaluate(self, change: Array) -> tuple[Array, Array]:
        """F and its derivative at changes [regions]."""
        step = self.nodes[1] - self.nodes[0]
        place = np.clip((change + _RANGE) / step, 0, _NODES - 1.001)
        node = place.astype(int)
        rows = np.arange(len(change))
        low, high = self.curves[rows, node], self.curves[rows, node + 1]
        share = (place - node)[:, None]
        wide = np.clip(node, 1, _NODES - 3)
        slope = (self.curves[rows, wide + 2] - self.curves[rows, wide - 1]) / (3 * step)
        return low + share * (high - low), slope


def _average_melanin(rest: RestingMaps, mask: NDArray[np.bool_]) -> float:
    return float(rest.melanin[_choose(rest, mask)].mean().clip(0.01, 0.4))


def _choose(rest: RestingMaps, mask: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """The skin of a region; that of the face for a region without any."""
    chosen = mask & rest.skin if (mask & rest.skin).any() else mask
    return chosen if chosen.any() else rest.skin


def _trace(
    colours: ColourTable,
    rest: RestingMaps,
    mask: NDArray[np.bool_],
    nodes: Array,
    factors: NDArray[np.float32],
) -> Array:
    """Mean colour of a region's texels at log changes of hemoglobin, [nodes, 3]."""
    chosen = _choose(rest, mask)
    factor = factors[1] * np.exp(nodes)[:, None].astype(np.float32)
    blood = np.minimum(rest.hemoglobin[chosen] * factor, np.float32(colours.top[1]))
    most = np.minimum(factors[0] * rest.melanin[chosen], np.float32(colours.top[0]))
    melanin = np.broadcast_to(most, blood.shape)
    bare = np.maximum(colours(melanin, blood), np.float32(_LEAST_COLOUR))
    lit = rest.shading[chosen][None, :, None] * (bare + rest.gloss[chosen][None, :, None])
    return np.asarray(lit.mean(1), np.float64)
