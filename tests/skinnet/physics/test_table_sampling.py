"""Samples are grid_sample's; gradients of the coordinates are those of the tabulated function."""

from collections.abc import Callable

import pytest
import torch
import torch.nn.functional as F

from skinnet.physics._table_sampling import extrapolate_ends, sample_table

D = torch.float64


def tabulate(function: Callable[..., torch.Tensor], rows: int, columns: int) -> torch.Tensor:
    """Nodes at -1/2, 1/2, ...; the first and last cells are lines through their middles."""
    row, column = (
        (torch.arange(nodes, dtype=D) - 0.5).clamp(0, nodes - 2) for nodes in (rows, columns)
    )
    table = function(row[:, None], column)
    return extrapolate_ends(extrapolate_ends(table, -1), -2)[None, None]


def sample_positions(rows: int, columns: int, count: int = 400) -> torch.Tensor:
    """Row and column [2, count] of points in the table's range, its corners among them."""
    last = torch.tensor([rows - 2.0, columns - 2.0], dtype=D)
    unit = torch.rand(count, 2, dtype=D, generator=torch.Generator().manual_seed(0))
    unit[:4] = torch.tensor([[0.0, 0.0], [0.0, 1.0], [1.0, 0.0], [1.0, 1.0]])
    return (unit * last).T


def to_grid(position: torch.Tensor, rows: int, columns: int) -> torch.Tensor:
    row, column = position
    return torch.stack(
        [(column + 0.5) / (columns - 1) * 2 - 1, (row + 0.5) / (rows - 1) * 2 - 1], -1
    )[None, None]


@pytest.mark.parametrize("axis", [-1, -2])
def test_outermost_cells_are_lines_through_the_ends(axis: int) -> None:
    values = torch.rand(3, 6, 5, dtype=D, generator=torch.Generator().manual_seed(0))
    ends, nodes = values.movedim(axis, 0), extrapolate_ends(values, axis).movedim(axis, 0)
    assert torch.equal(nodes[1:-1], ends[1:-1])
    assert torch.allclose((nodes[0] + nodes[1]) / 2, ends[0])
    assert torch.allclose((nodes[-1] + nodes[-2]) / 2, ends[-1])


@pytest.mark.parametrize("shape", [(4, 4), (4, 9), (8, 5)])
def test_gradients_of_a_quadratic_are_exact(shape: tuple[int, int]) -> None:
    def function(row: torch.Tensor, column: torch.Tensor) -> torch.Tensor:
        return 1 + 2 * row - 0.3 * row**2 + 0.5 * column + 0.7 * column**2

    position = sample_positions(*shape).requires_grad_()
    sample_table(tabulate(function, *shape), to_grid(position, *shape)).sum().backward()
    row, column = position.detach()
    exact = torch.stack([2 - 0.6 * row, 0.5 + 1.4 * column])
    assert position.grad is not None and torch.allclose(position.grad, exact, atol=1e-10)


def test_the_error_of_gradients_falls_with_the_square_of_the_step() -> None:
    def largest_error(nodes: int) -> float:
        step = 3 / (nodes - 2)
        position = sample_positions(nodes, nodes).requires_grad_()
        table = tabulate(lambda r, c: torch.exp(-step * r) * torch.sin(step * c), nodes, nodes)
        sample_table(table, to_grid(position, nodes, nodes)).sum().backward()
        row, column = step * position.detach()
        exact = step * torch.exp(-row) * torch.stack([-torch.sin(column), torch.cos(column)])
        assert position.grad is not None
        return ((position.grad - exact).abs().max() / step).item()

    assert largest_error(66) < 0.3 * largest_error(34) < 0.3 * 0.3 * largest_error(18)


def test_samples_and_gradients_of_the_table_are_those_of_grid_sample() -> None:
    rng = torch.Generator().manual_seed(0)
    table = torch.rand(2, 3, 6, 5, dtype=D, generator=rng, requires_grad=True)
    grid = to_grid(sample_positions(6, 5), 6, 5).expand(2, -1, -1, -1).clone().requires_grad_()
    weight = torch.randn(2, 3, 1, 400, dtype=D, generator=rng)
    ours = sample_table(table, grid)
    theirs = F.grid_sample(table, grid, align_corners=True)
    assert torch.equal(ours, theirs)
    gradients = [torch.autograd.grad((weight * image).sum(), table) for image in (ours, theirs)]
    assert torch.equal(*(gradient for (gradient,) in gradients))


def test_gradients_are_continuous_across_nodes() -> None:
    table = torch.rand(1, 1, 6, 5, dtype=D, generator=torch.Generator().manual_seed(0))
    node = to_grid(torch.tensor([[2.5], [1.5]], dtype=D), 6, 5)
    sides = [(node + shift).requires_grad_() for shift in (-1e-9, 1e-9)]
    ours = [torch.autograd.grad(sample_table(table, side).sum(), side)[0] for side in sides]
    assert torch.allclose(*ours, atol=1e-6)


def test_without_gradients_there_is_one_operator() -> None:
    arguments = torch.rand(1, 3, 4, 4), torch.zeros(1, 2, 2, 2)

    class Sampler(torch.nn.Module):
        def forward(self, table: torch.Tensor, grid: torch.Tensor) -> torch.Tensor:
            return sample_table(table, grid)

    graph = torch.export.export(Sampler(), arguments, strict=False).graph
    called = [str(node.target) for node in graph.nodes if node.op == "call_function"]
    assert sum("grid_sampler" in name for name in called) == 1 and len(called) <= 2
