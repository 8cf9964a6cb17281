"""The posterior of skins as a smooth function of their colour, tabulated and interpolated."""

import copy
from collections.abc import Sequence
from itertools import product

import torch
import torch.nn.functional as F
from jaxtyping import Float
from torch import Tensor

from skinnet.physics._posterior_nodes import PosteriorNodes

_SHAPE, _BLOCK = (80, 40, 48), (2, 4)
"""Nodes along the principal axes of colour, and nodes of the first two that share their skins."""

_SHIFT = 0.3
"""Constant added to colours before their logarithm, as a share of the palest skin's. More would
spend nodes on pale skin, less on dark skin."""

REACH = 5.0
"""Distance in standard deviations of a colour from that of a skin, up to which it is skin's."""

_MARGIN = 1.2
"""Distance from a colour, over `REACH`, beyond which a skin does not matter to its posterior."""

_FAR = 1e3
"""Distance where no skin is near."""

_LOGARITHMS = (0, 1, 3, 4)
"""Rows that are tabulated as logarithms."""

_COLOURS_AT_A_TIME, _PARTS = 1 << 17, 8
"""Colours that stay in the cache, and parts of them that threads share."""


class PosteriorTable:
    """Table of a posterior over the colours that skins have.

    Nodes are at equal steps along the principal axes of ln(colour + constant), which skin fills
    better than the axes of RGB.
    """

    def __init__(self, nodes: PosteriorNodes) -> None:
        shells = _surround(nodes)
        self._shift = _choose_shift(shells)
        logarithms = (shells + self._shift).log()
        self._axes = _find_principal_axes(logarithms, nodes.log_prior)
        shells = logarithms @ self._axes
        self._low, self._high = _widen(shells.amin((0, 1)), shells.amax((0, 1)))
        self._table = self._tabulate(nodes, shells)
        self._logarithms: tuple[int, ...] = _LOGARITHMS

    def select(self, rows: Sequence[int]) -> "PosteriorTable":
        """Make a table that gives only some rows, in a share of the time."""
        other = copy.copy(self)
        other._table = self._table[:, list(rows)].contiguous()
        other._logarithms = tuple(k for k, row in enumerate(rows) if row in _LOGARITHMS)
        return other

    def __call__(self, colours: Float[Tensor, "colours 3"]) -> Float[Tensor, "rows colours"]:
        """Interpolate the posterior of colours, float32.

        Returns:
            f_mel, its standard deviation and gain; the same of f_blood; distance from skin.
        """
        parts = [self._interpolate(part) for part in colours.split(_COLOURS_AT_A_TIME)]
        return torch.cat(parts, 1) if parts else colours.new_empty(self._table.shape[1], 0)

    def _interpolate(self, colours: Float[Tensor, "colours 3"]) -> Float[Tensor, "rows colours"]:
        scale = 2 / (self._high - self._low)
        axes, start = (self._axes * scale).float(), (-self._low * scale - 1).float()
        count = len(colours)
        padded = F.pad(colours.float(), (0, 0, 0, -count % _PARTS))
        tiny = self._shift.min().item() * 1e-3
        # grid_sample takes the last axis of the table first.
        position = torch.addmm(start, (padded + self._shift.float()).clamp_min_(tiny).log_(), axes)
        grid = position.flip(-1).reshape(_PARTS, 1, 1, -1, 3)
        table = self._table.expand(_PARTS, -1, -1, -1, -1)
        values = F.grid_sample(table, grid, align_corners=True, padding_mode="border")
        found = values[:, :, 0, 0].transpose(0, 1).reshape(values.shape[1], -1)[:, :count]
        for row in self._logarithms:
            found[row].exp_()
        return found

    def _tabulate(
        self, nodes: PosteriorNodes, shells: Float[Tensor, "nodes shell 3"]
    ) -> Float[Tensor, "1 7 *grid"]:
        """Compute the posterior at the nodes of the table, a block of near colours at a time."""
        ends = zip(self._low.tolist(), self._high.tolist(), _SHAPE, strict=True)
        axes = [torch.linspace(low, high, count, dtype=torch.float64) for low, high, count in ends]
        low, high = shells.amin(1), shells.amax(1)
        table = torch.zeros(*_SHAPE, 7)
        table[..., 6] = _FAR
        model = _prepare(nodes)
        for corner in product(range(0, _SHAPE[0], _BLOCK[0]), range(0, _SHAPE[1], _BLOCK[1])):
            block = tuple(slice(k, k + n) for k, n in zip(corner, _BLOCK, strict=True))
            near = torch.ones(len(low), dtype=torch.bool)
            for k, part in enumerate(block):
                near &= (low[:, k] <= axes[k][part][-1]) & (high[:, k] >= axes[k][part][0])
            if near.any():
                grid = torch.meshgrid(axes[0][block[0]], axes[1][block[1]], axes[2], indexing="ij")
                colours = (torch.stack(grid, -1) @ self._axes.T).exp() - self._shift
                found = _infer(colours.reshape(-1, 3), *(value[near] for value in model))
                values = _summarise(*found, nodes.mel_variance)
                table[block] = values.reshape(*colours.shape[:-1], 7)
        for axis in range(3):
            table.movedim(axis, 0)[[0, -1], ..., 6] = _FAR
        return table.movedim(-1, 0)[None].contiguous()


def _surround(nodes: PosteriorNodes) -> Float[Tensor, "nodes shell 3"]:
    """Colours around each node at the distance beyond which it does not matter."""
    directions = torch.tensor([d for d in product((-1.0, 0, 1), repeat=3) if any(d)]).double()
    directions = directions / directions.norm(dim=1, keepdim=True)
    root = torch.linalg.cholesky(nodes.covariance)
    shells: Tensor = nodes.colour[:, None] + _MARGIN * REACH * directions @ root.mT
    return shells


def _choose_shift(shells: Float[Tensor, "nodes shell 3"]) -> Float[Tensor, "3"]:
    """Constants that make every colour positive and the logarithm of dark colours almost linear."""
    least = shells.amin((0, 1))
    share = _SHIFT * shells.amax((0, 1))
    return torch.maximum(share, share / 2 - least)


def _find_principal_axes(
    logarithms: Float[Tensor, "nodes shell 3"], log_prior: Float[Tensor, "nodes"]
) -> Float[Tensor, "3 3"]:
    flat = logarithms.flatten(0, 1)
    weights = torch.softmax(log_prior, 0).repeat_interleave(logarithms.shape[1])
    flat = flat - weights @ flat / weights.sum()
    axes: Tensor = torch.linalg.eigh(flat.T @ (flat * weights[:, None]))[1]
    return axes.flip(1)


def _widen(
    low: Float[Tensor, "3"], high: Float[Tensor, "3"]
) -> tuple[Float[Tensor, "3"], Float[Tensor, "3"]]:
    """Move the ends a cell outward: nodes at the border are no skin's colours."""
    cell = (high - low) / (torch.tensor(_SHAPE) - 3)
    return low - cell, high + cell


def _prepare(nodes: PosteriorNodes) -> tuple[Tensor, Tensor, Tensor, Tensor]:
    """Means and whitening matrices of colours, logarithms of weights, and moments."""
    whitening = torch.linalg.inv(torch.linalg.cholesky(nodes.covariance))
    log_weights = nodes.log_prior + whitening.diagonal(dim1=-2, dim2=-1).log().sum(-1)
    return nodes.colour, whitening, log_weights, nodes.moments


def _infer(
    colours: Float[Tensor, "colours 3"],
    mean: Float[Tensor, "nodes 3"],
    whitening: Float[Tensor, "nodes 3 3"],
    log_weights: Float[Tensor, "nodes"],
    moments: Float[Tensor, "nodes 10"],
) -> tuple[Float[Tensor, "colours 10"], Float[Tensor, "colours"]]:
    """Posterior moments of colours, and distance from the nearest node's mean colour."""
    centre = colours.mean(0)
    start = (whitening @ (centre - mean)[..., None])[..., 0]
    whitened = torch.baddbmm(
        start.T[:, None].float(),
        (colours - centre).float().expand(3, -1, -1),
        whitening.permute(1, 2, 0).float(),
    )
    squared = whitened.square_().sum(0)
    distance = squared.amin(1).sqrt()
    weights = torch.softmax(log_weights.float() - 0.5 * squared, 1)
    return weights @ moments.float(), distance


def _summarise(
    moments: Float[Tensor, "colours 10"], distance: Float[Tensor, "colours"], mel_variance: float
) -> Float[Tensor, "colours 7"]:
    """Logarithms of means and standard deviations, gains, and distance."""
    first, second = moments[:, 0::2], moments[:, 1::2]
    least = torch.finfo(moments.dtype).eps * second.abs()
    variance = (second - first**2).clamp_min(least)
    priors = (torch.full_like(distance, mel_variance), variance[:, 4])
    summary = []
    for k, prior in enumerate(priors):
        mean, deviation = first[:, 2 + k].log(), 0.5 * variance[:, 2 + k].log()
        summary += [mean, deviation, 1 - variance[:, k] / prior]
    return torch.stack([*summary, distance], 1)
