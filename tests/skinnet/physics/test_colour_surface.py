"""The surface goes through its half steps, its derivatives are right, and feet are nearest."""

import numpy as np
import pytest
from jaxtyping import Float

from skinnet.physics._colour_surface import Surface


def bowl(rows: int = 9, columns: int = 7) -> Float[np.ndarray, "rows columns 3"]:
    """A curved sheet whose coordinates are biquadratic, so that the surface is exactly it."""
    r, c = np.meshgrid(np.linspace(0, 1, rows), np.linspace(0, 1, columns), indexing="ij")
    return np.stack([r, c + 0.2 * r**2, 0.3 * (r - 0.4) ** 2 + 0.2 * c**2 * r], -1)


def exact(place: Float[np.ndarray, "2 n"]) -> Float[np.ndarray, "3 n"]:
    r, c = place[0] / 4, place[1] / 3
    return np.stack([r, c + 0.2 * r**2, 0.3 * (r - 0.4) ** 2 + 0.2 * c**2 * r])


def places(count: int = 200) -> Float[np.ndarray, "2 n"]:
    return np.random.default_rng(0).uniform(0, [[4], [3]], (2, count))


@pytest.mark.parametrize("dtype", [np.float64, np.float32])
def test_it_goes_through_its_half_steps(dtype: type) -> None:
    halves = np.random.default_rng(1).normal(0, 1, (9, 7, 3))
    surface = Surface(halves).to(np.dtype(dtype))
    place = np.stack(np.meshgrid(np.arange(9) / 2, np.arange(7) / 2, indexing="ij")).reshape(2, -1)
    found = surface.colour(place.astype(dtype))
    assert found.dtype == dtype
    np.testing.assert_allclose(
        found.T, halves.reshape(-1, 3), atol=1e-14 if dtype is float else 3e-6
    )


def test_what_is_biquadratic_is_exact() -> None:
    np.testing.assert_allclose(Surface(bowl()).colour(places()), exact(places()), atol=1e-14)


def test_derivatives_are_those_of_differences() -> None:
    surface = Surface(np.random.default_rng(1).normal(0, 1, (9, 7, 3)))
    place, step = np.floor(places()) + 0.3, 1e-6
    jet = surface.at(place)
    np.testing.assert_allclose(jet.colour, surface.colour(place))
    moves = np.eye(2)[:, :, None] * step
    first = [(surface.colour(place + m) - surface.colour(place - m)) / (2 * step) for m in moves]
    np.testing.assert_allclose(jet.by_row, first[0], atol=1e-7)
    np.testing.assert_allclose(jet.by_column, first[1], atol=1e-7)
    ahead, behind = ([surface.at(place + s * m) for m in moves] for s in (1, -1))
    second = [(ahead[k].by_row - behind[k].by_row) / (2 * step) for k in (0, 1)]
    np.testing.assert_allclose(jet.by_rows, second[0], atol=1e-7)
    np.testing.assert_allclose(jet.by_both, second[1], atol=1e-7)
    columns = (ahead[1].by_column - behind[1].by_column) / (2 * step)
    np.testing.assert_allclose(jet.by_columns, columns, atol=1e-7)


def test_a_foot_is_found_again_off_the_surface() -> None:
    surface, place = Surface(bowl()), places()
    jet = surface.at(place)
    normal = np.cross(jet.by_row, jet.by_column, axis=0)
    colours = jet.colour + 0.1 * normal / np.linalg.norm(normal, axis=0)
    found = surface.foot(colours, np.round(place))
    np.testing.assert_allclose(found, place, atol=1e-5)


def test_feet_are_nearer_than_anything_on_a_fine_grid() -> None:
    surface = Surface(bowl())
    colours = np.random.default_rng(2).uniform(-0.5, 1.5, (3, 100))
    fine = np.stack(np.meshgrid(np.linspace(0, 4, 201), np.linspace(0, 3, 151), indexing="ij"))
    sheet = surface.colour(fine.reshape(2, -1))
    apart = np.linalg.norm(colours[:, :, None] - sheet[:, None], axis=0)
    start = fine.reshape(2, -1)[:, apart.argmin(1)]
    found = surface.foot(colours, start)
    assert (found >= 0).all() and (found <= [[4], [3]]).all()
    assert (np.linalg.norm(colours - surface.colour(found), axis=0) <= apart.min(1) + 1e-9).all()


def test_a_line_for_a_surface_has_feet() -> None:
    line = np.linspace(0, 1, 9)[:, None, None] * np.ones((1, 7, 3))
    for dtype in (np.dtype(np.float64), np.dtype(np.float32)):
        surface = Surface(line).to(dtype)
        colours = np.random.default_rng(3).uniform(0, 1, (3, 50)).astype(dtype)
        found = surface.foot(colours, np.ones((2, 50), dtype))
        np.testing.assert_allclose(found[0], 4 * colours.mean(0), atol=1e-4)
