"""Quadrilaterals that lie in a grid, and the perspective of the grid."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

_PITCH = 1.2
"""Distance between neighbours in sides of a patch, before any neighbour is known."""

_TOLERANCE, _SIZE_RATIO = 0.35, 1.7
"""How far from the expected place a neighbour is, in distances, and how its size may differ."""

_LEAST = 8
"""Least members of a grid."""

_STEPS = (1, 0), (-1, 0), (0, 1), (0, -1)


class Lattice(NamedTuple):
    """Quadrilaterals of a grid: column and row of each [n, 2], and its centre [n, 2] in pixels."""

    cells: NDArray[np.int64]
    centres: Array


def find_lattices(quads: Array) -> list[Lattice]:
    """Find grids among quadrilaterals [n, 4, 2], the largest first."""
    free = set(range(len(quads)))
    found = []
    while free:
        cells = _grow(quads, min(free))
        free -= set(cells) | {min(free)}
        if len(cells) >= _LEAST:
            rows = np.array(list(cells.values()))
            found.append(Lattice(rows - rows.min(0), quads[list(cells)].mean(1)))
    return sorted(found, key=lambda lattice: -len(lattice.cells))


def _grow(quads: Array, seed: int) -> dict[int, tuple[int, int]]:
    """Column and row of each member, by its number, from neighbour to neighbour."""
    centres = quads.mean(1)
    sides = np.sqrt(np.abs(_find_areas(quads)))
    cells, taken = {seed: (0, 0)}, {(0, 0)}
    queue = [(seed, *_find_axes(quads[seed]))]
    while queue:
        member, right, down = queue.pop(0)
        for across, along in _STEPS:
            step = across * right + along * down
            cell = cells[member][0] + across, cells[member][1] + along
            near = np.hypot(*(centres - centres[member] - step).T)
            ratio = np.maximum(sides / sides[member], sides[member] / sides)
            near[(ratio > _SIZE_RATIO) | np.isin(np.arange(len(quads)), list(cells))] = np.inf
            other = int(near.argmin())
            if cell in taken or near[other] > _TOLERANCE * np.hypot(*step):
                continue
            cells[other] = cell
            taken.add(cell)
            moved = (across + along) * (centres[other] - centres[member])
            queue.append((other, moved, down) if across else (other, right, moved))
    return cells


def _find_axes(quad: Array) -> tuple[Array, Array]:
    """Steps to the next column and row, the second clockwise from the first."""
    right, other = _PITCH * (quad[1] - quad[0]), _PITCH * (quad[2] - quad[1])
    clockwise = right[0] * other[1] - right[1] * other[0] > 0
    return right, other if clockwise else -other


def _find_areas(quads: Array) -> Array:
    x, y = np.moveaxis(quads, -1, 0)
    return np.asarray((x * np.roll(y, -1, 1) - y * np.roll(x, -1, 1)).sum(1) / 2)
