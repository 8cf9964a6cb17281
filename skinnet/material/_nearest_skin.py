"""The skins nearest to very many colours: a table of starts, then steps on the colour surface."""

import numpy as np
import torch
import torch.nn.functional as F
from jaxtyping import Float
from torch import Tensor

from skinnet.physics._pigment_axis import PigmentAxis
from skinnet.physics.inversion import F_BLOOD_RANGE, F_MEL_RANGE, SkinInverse
from skinnet.physics.lookup import SkinLookup

_SIDE = 33
"""Nodes of the table of starts along each channel."""

_NODES = (128, 128)
_STEPS = 2
"""Steps after which colours of skin differ from `SkinInverse` by less than a step of 16 bits."""

_COLOURS_AT_A_TIME = 1 << 17
"""Colours that stay in the cache."""

_TINY = 1e-30


class NearestSkin:
    """Fractions of the nearest colour of skin: the answer of `SkinInverse` for very many colours.

    A table over square roots of linear RGB gives a position near the answer. Then Gauss-Newton
    steps, each from the node of the inverse's own table that is nearest to the last position, go to
    the closest point of the plane that touches the surface there. A colour far from skin keeps the
    position of the table, which is smooth, since such steps may diverge.

    Args:
        lookup: Skin whose colours are tabulated.
        matrix: Spectrum-to-RGB matrix of light, camera and colour transform.

    Source:
        Section 4.4 of Alotaibi & Smith 2017: the nearest colour of a table.
    """

    def __init__(self, lookup: SkinLookup, matrix: Float[Tensor, "wavelength 3"]) -> None:
        ranges = (F_MEL_RANGE, F_BLOOD_RANGE)
        self._axes = [
            PigmentAxis(*ends, nodes, spacing)
            for ends, nodes, spacing in zip(ranges, _NODES, lookup.spacing, strict=True)
        ]
        inverse = lookup.inverse(matrix, _NODES, *ranges)
        self._tangents = _tabulate_tangents(inverse.colours)
        self._starts = self._tabulate_starts(inverse)

    def __call__(
        self, rgb: Float[Tensor, "colours 3"], weight: Float[Tensor, "colours"]
    ) -> Float[Tensor, "2 colours"]:
        """Find f_mel and f_blood of finite linear RGB, float32.

        `weight` is 1 where steps are taken, and 0 where the table's position stays.
        """
        parts = zip(*(one.split(_COLOURS_AT_A_TIME) for one in (rgb, weight)), strict=True)
        found = [self._find(*part) for part in parts]
        return torch.cat(found, 1) if found else rgb.new_empty(2, 0)

    def _find(
        self, rgb: Float[Tensor, "colours 3"], weight: Float[Tensor, "colours"]
    ) -> Float[Tensor, "2 colours"]:
        position = start = self._start(rgb)
        channels = rgb.T.contiguous()
        for _ in range(_STEPS):
            position = self._step(channels, position)
        position = torch.lerp(start, position, weight)
        return torch.stack(
            [
                torch.expm1(place * axis.step).mul_(axis.spacing)
                for place, axis in zip(position, self._axes, strict=True)
            ]
        )

    def _start(self, rgb: Float[Tensor, "colours 3"]) -> Float[Tensor, "2 colours"]:
        grid = 2 * rgb.clamp(0, 1).sqrt().flip(-1) - 1
        values = F.grid_sample(
            self._starts, grid[None, None, None], align_corners=True, padding_mode="border"
        )
        return values[0, :, 0, 0]

    def _step(
        self, rgb: Float[Tensor, "3 colours"], position: Float[Tensor, "2 colours"]
    ) -> Float[Tensor, "2 colours"]:
        """Closest points of the planes at the nodes nearest to positions, within the table."""
        node = position.round()
        index = (node[0] * _NODES[1] + node[1]).int()
        values = self._tangents.index_select(0, index).T
        residual = rgb - values[:3]
        by_mel, by_blood = ((residual * values[k : k + 3]).sum(0) for k in (3, 6))
        aa, ab, bb, inverse = values[9:]
        # The steps of `clipped_newton_step` in physics, for tables of products.
        mel = (node[0] + (bb * by_mel - ab * by_blood) * inverse).clamp_(0, _NODES[0] - 1)
        blood = (node[1] + (by_blood - ab * (mel - node[0])) / bb).clamp_(0, _NODES[1] - 1)
        mel = (node[0] + (by_mel - ab * (blood - node[1])) / aa).clamp_(0, _NODES[0] - 1)
        return torch.stack([mel, blood])

    def _tabulate_starts(self, inverse: SkinInverse) -> Float[Tensor, "1 2 side side side"]:
        """Positions of the nearest skins, over square roots of linear RGB."""
        axis = torch.linspace(0, 1, _SIDE) ** 2
        found = inverse(torch.stack(torch.meshgrid(axis, axis, axis, indexing="ij"), -1))
        positions = [
            torch.log1p(fraction / each.spacing) / each.step
            for fraction, each in zip(found[:2], self._axes, strict=True)
        ]
        return torch.stack(positions)[None].float()


def _tabulate_tangents(colours: Float[Tensor, "mel blood 3"]) -> Float[Tensor, "nodes 13"]:
    """Colours, their derivatives by both positions, and products of these, a node a row."""
    values = colours.numpy()
    by_mel, by_blood = np.gradient(values, axis=(0, 1), edge_order=2)
    aa, ab, bb = (
        (one * other).sum(-1, keepdims=True) + tiny
        for one, other, tiny in (
            (by_mel, by_mel, _TINY),
            (by_mel, by_blood, 0),
            (by_blood, by_blood, _TINY),
        )
    )
    planes = [values, by_mel, by_blood, aa, ab, bb, 1 / (aa * bb - ab**2 + _TINY)]
    return torch.from_numpy(np.concatenate(planes, -1)).float().flatten(0, 1).contiguous()
