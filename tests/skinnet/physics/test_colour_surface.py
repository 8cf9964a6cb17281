"""The surface interpolates its half steps, has the right derivatives, and finds closest points."""

import numpy as np
import pytest
from jaxtyping import Float

from skinnet.physics._colour_surface import ColourSurface, clipped_newton_step


def bowl(rows: int = 9, columns: int = 7) -> Float[np.ndarray, "rows columns 3"]:
    """Curved colours that are biquadratic, so that the surface interpolates them exactly."""
    r, c = np.meshgrid(np.linspace(0, 1, rows), np.linspace(0, 1, columns), indexing="ij")
    return np.stack([r, c + 0.2 * r**2, 0.3 * (r - 0.4) ** 2 + 0.2 * c**2 * r], -1)


def exact(position: Float[np.ndarray, "2 n"]) -> Float[np.ndarray, "3 n"]:
    r, c = position[0] / 4, position[1] / 3
    return np.stack([r, c + 0.2 * r**2, 0.3 * (r - 0.4) ** 2 + 0.2 * c**2 * r])


def positions(count: int = 200) -> Float[np.ndarray, "2 n"]:
    return np.random.default_rng(0).uniform(0, [[4], [3]], (2, count))


@pytest.mark.parametrize("dtype", [np.float64, np.float32])
def test_it_interpolates_its_half_steps(dtype: type) -> None:
    half_steps = np.random.default_rng(1).normal(0, 1, (9, 7, 3))
    surface = ColourSurface(half_steps).to(np.dtype(dtype))
    position = np.stack(np.meshgrid(np.arange(9) / 2, np.arange(7) / 2, indexing="ij")).reshape(
        2, -1
    )
    found = surface.evaluate(position.astype(dtype))
    assert found.dtype == dtype
    np.testing.assert_allclose(
        found.T, half_steps.reshape(-1, 3), atol=1e-14 if dtype is float else 3e-6
    )


def test_biquadratic_colours_are_exact() -> None:
    np.testing.assert_allclose(
        ColourSurface(bowl()).evaluate(positions()), exact(positions()), atol=1e-14
    )


def test_derivatives_agree_with_finite_differences() -> None:
    surface = ColourSurface(np.random.default_rng(1).normal(0, 1, (9, 7, 3)))
    position, step = np.floor(positions()) + 0.3, 1e-6
    found = surface.differentiate(position)
    np.testing.assert_allclose(found.colour, surface.evaluate(position))
    moves = np.eye(2)[:, :, None] * step
    first = [
        (surface.evaluate(position + m) - surface.evaluate(position - m)) / (2 * step)
        for m in moves
    ]
    np.testing.assert_allclose(found.row, first[0], atol=1e-7)
    np.testing.assert_allclose(found.column, first[1], atol=1e-7)
    ahead, behind = ([surface.differentiate(position + s * m) for m in moves] for s in (1, -1))
    second = [(ahead[k].row - behind[k].row) / (2 * step) for k in (0, 1)]
    np.testing.assert_allclose(found.row_row, second[0], atol=1e-7)
    np.testing.assert_allclose(found.row_column, second[1], atol=1e-7)
    columns = (ahead[1].column - behind[1].column) / (2 * step)
    np.testing.assert_allclose(found.column_column, columns, atol=1e-7)


def test_a_colour_off_the_surface_projects_along_the_normal() -> None:
    surface, position = ColourSurface(bowl()), positions()
    derivatives = surface.differentiate(position)
    normal = np.cross(derivatives.row, derivatives.column, axis=0)
    colours = derivatives.colour + 0.1 * normal / np.linalg.norm(normal, axis=0)
    found = surface.project(colours, np.round(position))
    np.testing.assert_allclose(found, position, atol=1e-5)


def test_no_point_of_a_fine_grid_is_closer() -> None:
    surface = ColourSurface(bowl())
    colours = np.random.default_rng(2).uniform(-0.5, 1.5, (3, 100))
    fine = np.stack(np.meshgrid(np.linspace(0, 4, 201), np.linspace(0, 3, 151), indexing="ij"))
    on_surface = surface.evaluate(fine.reshape(2, -1))
    distance = np.linalg.norm(colours[:, :, None] - on_surface[:, None], axis=0)
    start = fine.reshape(2, -1)[:, distance.argmin(1)]
    found = surface.project(colours, start)
    assert (found >= 0).all() and (found <= [[4], [3]]).all()
    closest = np.linalg.norm(colours - surface.evaluate(found), axis=0)
    assert (closest <= distance.min(1) + 1e-9).all()


@pytest.mark.parametrize("dtype", [np.float64, np.float32])
def test_a_surface_that_is_a_line_has_closest_points(dtype: type) -> None:
    line = np.linspace(0, 1, 9)[:, None, None] * np.ones((1, 7, 3))
    surface = ColourSurface(line).to(np.dtype(dtype))
    colours = np.random.default_rng(3).uniform(0, 1, (3, 50)).astype(dtype)
    found = surface.project(colours, np.ones((2, 50), dtype))
    np.testing.assert_allclose(found[0], 4 * colours.mean(0), atol=1e-4)


def quadratics(count: int = 500) -> tuple[Float[np.ndarray, "2 n"], Float[np.ndarray, "n 2 2"]]:
    """Random descents, and Hessians that are positive definite."""
    rng = np.random.default_rng(4)
    root = rng.normal(0, 1, (count, 2, 2))
    return rng.normal(0, 2, (2, count)), root @ root.transpose(0, 2, 1) + 0.1 * np.eye(2)


def entries(hessian: Float[np.ndarray, "n 2 2"]) -> Float[np.ndarray, "3 n"]:
    return np.stack([hessian[:, 0, 0], hessian[:, 0, 1], hessian[:, 1, 1]])


def test_without_bounds_a_step_is_newtons() -> None:
    descent, hessian = quadratics()
    far = np.full(descent.shape, 1e9)
    found = clipped_newton_step(descent, entries(hessian), -far, far)
    expected = np.linalg.solve(hessian, descent.T[..., None])[..., 0].T
    np.testing.assert_allclose(found, expected, rtol=1e-9, atol=1e-12)


def test_a_clipped_step_stays_in_its_bounds_and_descends() -> None:
    descent, hessian = quadratics()
    low, high = -np.random.default_rng(5).uniform(0, 1, (2, *descent.shape))
    found = clipped_newton_step(descent, entries(hessian), low, -high)
    assert (found >= low).all() and (found <= -high).all()
    curvature = np.einsum("an,nab,bn->n", found, hessian, found)
    assert (0.5 * curvature - (descent * found).sum(0) <= 1e-12).all()


@pytest.mark.parametrize("axis", [0, 1])
def test_a_step_with_one_bound_is_the_exact_minimum(axis: int) -> None:
    descent, hessian = quadratics()
    low, high = np.full(descent.shape, -1e9), np.full(descent.shape, 1e9)
    high[axis] = 0.1
    found = clipped_newton_step(descent, entries(hessian), low, high)
    gradient = np.einsum("nab,bn->an", hessian, found) - descent
    at_bound = found[axis] == high[axis]
    assert 50 < at_bound.sum() < 450
    np.testing.assert_allclose(gradient[1 - axis], 0, atol=1e-9)
    np.testing.assert_allclose(gradient[axis, ~at_bound], 0, atol=1e-9)
    assert (gradient[axis, at_bound] <= 1e-9).all()
