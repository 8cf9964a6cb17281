"""Bilinear samples of tables, with gradients that are continuous from cell to cell.

A table's range ends in the middles of its outermost cells.
"""

from typing import Any

import torch
import torch.nn.functional as F
from jaxtyping import Float
from torch import Tensor
from torch.autograd.function import once_differentiable


def extrapolate_ends(values: Float[Tensor, "*shape"], axis: int) -> Float[Tensor, "*shape"]:
    """Compute values at all nodes of an axis from those at the range's ends and the inner nodes.

    The first and the last cell are lines through their inner node and their middle, so that
    nothing is evaluated outside the range.

    Args:
        values: At the first end, the inner nodes and the last end.
        axis: The axis.

    Returns:
        Values at the nodes.
    """
    low, second = values.narrow(axis, 0, 1), values.narrow(axis, 1, 1)
    high, previous = values.narrow(axis, -1, 1), values.narrow(axis, -2, 1)
    inner = values.narrow(axis, 1, values.shape[axis] - 2)
    return torch.cat([2 * low - second, inner, 2 * high - previous], axis)


def sample_table(
    table: Float[Tensor, "batch channels rows columns"],
    grid: Float[Tensor, "batch height width 2"],
) -> Float[Tensor, "batch channels height width"]:
    """Interpolate bilinearly; coordinates are those of `grid_sample`, -1 and 1 at the outer nodes.

    The gradient of a bilinear sample is constant across a cell, and right only in its middle. Here
    the gradient of the coordinates is interpolated between the middles, which makes it an
    approximation of second order to that of the tabulated function. The gradient of the table is
    that of the sample.

    Args:
        table: Values at the nodes; at least 3 rows and columns.
        grid: Coordinates of the column and the row, within the range.

    Returns:
        Samples.
    """
    image = _interpolate(table, grid.detach())
    # Without gradients there is one operator, so that exported graphs stay small.
    return _SmoothGradient.apply(image, table.detach(), grid) if grid.requires_grad else image


class _SmoothGradient(torch.autograd.Function):
    """Returns `image` and passes its gradient on, to the grid by way of the table's slopes."""

    @staticmethod
    def forward(ctx: Any, image: Tensor, table: Tensor, grid: Tensor) -> Tensor:
        ctx.save_for_backward(table, grid)
        return image.view_as(image)

    @staticmethod
    @once_differentiable
    def backward(ctx: Any, gradient: Tensor) -> tuple[Tensor, None, Tensor]:
        table, grid = ctx.saved_tensors
        table = table.to(grid)
        # In place: a map of three channels is the largest thing here.
        by_axis = [_sample_slope(table, grid, axis).mul_(gradient).sum(1) for axis in (-1, -2)]
        return gradient, None, torch.stack(by_axis, -1)


def _sample_slope(table: Tensor, grid: Tensor, axis: int) -> Tensor:
    """Derivative by the coordinate of an axis, interpolated between the middles of the cells."""
    nodes = table.shape[axis]
    slope = table.diff(dim=axis) * ((nodes - 1) / 2)
    first, second = slope.narrow(axis, 0, 1), slope.narrow(axis, 1, 1)
    last, previous = slope.narrow(axis, -1, 1), slope.narrow(axis, -2, 1)
    # The outermost cells are lines through half a step, so their slope is that of a quarter.
    ends = (4 * first - second) / 3, (4 * last - previous) / 3
    slope = torch.cat([ends[0], slope.narrow(axis, 1, nodes - 3), ends[1]], axis)
    # The middles span the nodes' interval less one cell.
    scale = grid.new_ones(2)
    scale[0 if axis == -1 else 1] = (nodes - 1) / (nodes - 2)
    return _interpolate(slope, grid * scale)


def _interpolate(table: Tensor, grid: Tensor) -> Tensor:
    return F.grid_sample(table, grid, align_corners=True, padding_mode="border")
