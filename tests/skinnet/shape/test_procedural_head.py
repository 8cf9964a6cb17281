"""The procedural head is symmetric, has its features in their places, and varies."""

import pytest
import torch

from skinnet.shape._procedural_head import (
    CHART_EXTENT,
    IDENTITY_SIZE,
    compute_chart_angles,
    compute_head_radius,
)

ROWS, COLUMNS = 61, 81


def sample_radius(radius: torch.Tensor, azimuth: float, elevation: float) -> float:
    """The radius [1, 1, rows, columns] at the texel nearest to two angles."""
    across, along = compute_chart_angles(ROWS, COLUMNS)
    row = (along - elevation).abs().argmin()
    column = (across - azimuth).abs().argmin()
    return radius[0, 0, row, column].item()


def test_the_chart_runs_from_the_upper_right_of_the_face_to_the_lower_left() -> None:
    azimuth, elevation = compute_chart_angles(ROWS, COLUMNS)
    assert azimuth.shape == (1, COLUMNS) and elevation.shape == (ROWS, 1)
    assert azimuth[0, [0, -1]].tolist() == [-CHART_EXTENT[0], CHART_EXTENT[0]]
    assert elevation[[0, -1], 0].tolist() == [CHART_EXTENT[1], -CHART_EXTENT[1]]


def test_the_mean_head_is_its_own_mirror_image() -> None:
    radius = compute_head_radius(torch.zeros(1, IDENTITY_SIZE), ROWS, COLUMNS)
    assert torch.allclose(radius, radius.flip(-1), atol=1e-5)


def test_the_nose_stands_out_and_the_eyes_lie_back() -> None:
    radius = compute_head_radius(torch.zeros(1, IDENTITY_SIZE), ROWS, COLUMNS)
    places = ((0.0, -0.33), (0.34, 0.05), (0.0, 0.5))
    nose, eye, forehead = (sample_radius(radius, *place) for place in places)
    assert nose > forehead > eye


@pytest.mark.parametrize("dtype", [torch.float32, torch.float64])
def test_the_surface_looks_outside(dtype: torch.dtype) -> None:
    rng = torch.Generator().manual_seed(0)
    identity = torch.randn(3, IDENTITY_SIZE, generator=rng, dtype=dtype)
    radius = compute_head_radius(identity, ROWS, COLUMNS)
    azimuth, elevation = (angles.to(dtype) for angles in compute_chart_angles(ROWS, COLUMNS))
    x, z = elevation.cos() * azimuth.sin(), elevation.cos() * azimuth.cos()
    direction = torch.stack([x, elevation.sin().expand_as(x), z])
    down, right = torch.gradient(radius * direction, dim=(2, 3))
    normal = torch.linalg.cross(down, right, dim=1)
    assert radius.dtype == dtype
    assert ((normal * direction).sum(1) > 0).double().mean() > 0.99


def test_identities_differ() -> None:
    rng = torch.Generator().manual_seed(1)
    identity = torch.randn(2, IDENTITY_SIZE, generator=rng)
    radius = compute_head_radius(identity, ROWS, COLUMNS)
    assert (radius[0] - radius[1]).abs().max() > 0.02
