"""The procedural head is a closed, mirrored surface with normals that point out."""

import torch

from skinnet.shape.procedural_head import IDENTITY, chart, relief, sample, surface

ROWS, COLUMNS = 61, 81


def direction() -> torch.Tensor:
    azimuth, elevation = chart(ROWS, COLUMNS)
    x, y, z = (
        elevation.cos() * azimuth.sin(),
        elevation.sin().expand(-1, COLUMNS),
        elevation.cos() * azimuth.cos(),
    )
    return torch.stack([x, y, z])[None]


def test_the_mean_head_is_its_own_mirror_image() -> None:
    radius = relief(torch.zeros(1, IDENTITY), ROWS, COLUMNS)
    assert torch.allclose(radius, radius.flip(-1), atol=1e-5)


def test_the_nose_stands_out_and_the_eyes_lie_back() -> None:
    radius = relief(torch.zeros(1, IDENTITY), ROWS, COLUMNS)
    probes = torch.tensor([[0.0, -0.33], [0.34, 0.05], [0.0, 0.5]])
    azimuth, elevation = probes.unbind(1)
    toward = torch.stack(
        [elevation.cos() * azimuth.sin(), elevation.sin(), elevation.cos() * azimuth.cos()]
    )[None, :, None]
    nose, eye, forehead = sample(radius, toward).flatten().tolist()
    assert nose > forehead > eye


def test_normals_are_unit_vectors_that_point_out() -> None:
    lot = torch.Generator().manual_seed(0)
    heads = surface(relief(torch.randn(3, IDENTITY, generator=lot), ROWS, COLUMNS))
    assert torch.allclose(heads.normal.norm(dim=1), torch.ones(3, ROWS, COLUMNS), atol=1e-4)
    assert ((heads.normal * direction()).sum(1) > 0).float().mean() > 0.99


def test_sampling_a_chart_at_its_texels_gives_their_values() -> None:
    radius = relief(torch.zeros(1, IDENTITY), ROWS, COLUMNS)
    assert torch.allclose(sample(radius, direction()), radius, atol=1e-4)


def test_identities_differ() -> None:
    lot = torch.Generator().manual_seed(1)
    radius = relief(torch.randn(2, IDENTITY, generator=lot), ROWS, COLUMNS)
    assert (radius[0] - radius[1]).abs().max() > 0.02
