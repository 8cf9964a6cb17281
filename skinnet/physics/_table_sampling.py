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
    if not grid.requires_grad:
        return image
    smooth: Tensor = _SmoothGradient.apply(image, table.detach(), grid)  # type: ignore[no-untyped-call]
    return smooth


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
        by_grid = torch.empty_like(grid)
        for component, axis in enumerate((-1, -2)):
            slope = _interpolate(_differentiate(table.to(grid), axis), grid)
            # In place: allocating a map of three channels takes as long as filling it.
            torch.sum(slope.mul_(gradient), 1, out=by_grid[..., component])
        return gradient, None, by_grid


def _differentiate(table: Tensor, axis: int) -> Tensor:
    """Derivative at the nodes by the coordinate of an axis."""
    table = table.movedim(axis, 0)
    # A difference is right in the middle of its cell. The range ends in the middles of the
    # outermost, which are lines through half a step: their difference is right at a quarter.
    middle = table.diff(dim=0) * ((len(table) - 1) / 2)
    middle[0] = (4 * middle[0] - middle[1]) / 3
    middle[-1] = (4 * middle[-1] - middle[-2]) / 3
    node = torch.empty_like(table)
    node[1:-1] = (middle[1:] + middle[:-1]) / 2
    node[2:-2] -= (middle[3:] - middle[2:-1] - middle[1:-2] + middle[:-3]) / 16
    node[0], node[-1] = 2 * middle[0] - node[1], 2 * middle[-1] - node[-2]
    return node.movedim(0, axis)


def _interpolate(table: Tensor, grid: Tensor) -> Tensor:
    return F.grid_sample(table, grid, align_corners=True, padding_mode="border")
