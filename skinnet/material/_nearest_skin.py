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

_TINY = 1e-25
"""Keeps the products of parallel derivatives invertible."""


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
        mel, blood = (
            (residual * values[k : k + 3]).sum(0).add_(place)
            for k, place in zip((3, 6), node, strict=True)
        )
        # As `clipped_newton_step` in physics: at a border the best place along it is another one.
        clipped = mel.clamp(0, _NODES[0] - 1)
        inner = torch.addcmul(blood, mel - clipped, values[9]).clamp_(0, _NODES[1] - 1)
        mel = torch.addcmul(mel, blood - inner, values[10]).clamp_(0, _NODES[0] - 1)
        return torch.stack([mel, inner])

    def _tabulate_starts(self, inverse: SkinInverse) -> Float[Tensor, "1 2 side side side"]:
        """Positions of the nearest skins, over square roots of linear RGB."""
        axis = torch.linspace(0, 1, _SIDE) ** 2
        found = inverse(torch.stack(torch.meshgrid(axis, axis, axis, indexing="ij"), -1))
        positions = [
            torch.log1p(fraction / each.spacing) / each.step
            for fraction, each in zip(found[:2], self._axes, strict=True)
        ]
        return torch.stack(positions)[None].float()


def _tabulate_tangents(colours: Float[Tensor, "mel blood 3"]) -> Float[Tensor, "nodes 11"]:
    """Tabulate the planes that touch the surface of colours, a node a row.

    Returns:
        The colour; what takes a difference of colours to steps of melanin and of blood; how far
        blood goes for each step that melanin does not, and melanin for blood.
    """
    values = colours.numpy()
    derivatives = np.stack(np.gradient(values, axis=(0, 1), edge_order=2), -2)
    products = derivatives @ derivatives.swapaxes(-1, -2) + _TINY * np.eye(2)
    steps = np.linalg.solve(products, derivatives)
    shares = products[..., :1, 1] / np.diagonal(products, axis1=-2, axis2=-1)[..., ::-1]
    rows = np.concatenate([values, steps[..., 0, :], steps[..., 1, :], shares], -1)
    return torch.from_numpy(rows).float().flatten(0, 1).contiguous()
