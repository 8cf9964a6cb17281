"""The table: its error over the unit square and at its edges, and that it is never stale."""

import copy
import pickle

import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st
from torch import nn

from skinnet.physics.decoder import SkinDecoder
from skinnet.physics.lookup import SkinLookup
from skinnet.physics.optics import PRESETS, SkinOptics
from skinnet.physics.reflectance import SkinReflectance

D = torch.float64


def maps(*shape: int, seed: int = 0) -> tuple[torch.Tensor, torch.Tensor]:
    f_mel, f_blood = torch.rand(2, *shape, generator=torch.Generator().manual_seed(seed), dtype=D)
    return f_mel, f_blood


def thick(value: float = 0.05) -> SkinOptics:
    return SkinOptics.preset("measured", d_epd=value)


@pytest.mark.parametrize("preset", PRESETS)
def test_nodes_hold_the_closed_form(preset: str) -> None:
    reflectance = SkinReflectance(preset, dtype=D)
    lookup = SkinLookup(reflectance, nodes=(12, 9))
    inner = lookup.fractions(0)[1:-1, None], lookup.fractions(1)[None, 1:-1]
    assert torch.equal(lookup.spectra()[1:-1, 1:-1], reflectance(*inner))


def test_the_outermost_cells_pass_through_the_edges_of_the_square() -> None:
    lookup = SkinLookup(SkinReflectance(dtype=D))
    for axis in (0, 1):
        fractions = lookup.fractions(axis)
        assert fractions[0] == 0 and fractions[-1] == pytest.approx(1, abs=1e-12)
        assert (fractions.diff() > 0).all()
    corners = torch.tensor([0.0, 1.0], dtype=D)
    colours = lookup.colours(torch.eye(33, 3, dtype=D)[None])
    sampled = lookup.sample(
        colours, corners[None, :, None].expand(1, 2, 2), corners.expand(1, 2, 2)
    )
    exact = lookup.reflectance(corners[:, None], corners)[..., :3].movedim(-1, 0)
    assert torch.allclose(sampled[0], exact, atol=1e-12)


def test_sampling_at_a_node_gives_its_colour() -> None:
    lookup = SkinLookup(SkinReflectance(dtype=D), nodes=(12, 9))
    colours = lookup.colours(torch.rand(1, 33, 3, dtype=D))
    f_mel, f_blood = torch.meshgrid(
        lookup.fractions(0)[1:-1], lookup.fractions(1)[1:-1], indexing="ij"
    )
    sampled = lookup.sample(colours, f_mel[None], f_blood[None])
    assert torch.allclose(sampled, colours[..., 1:-1, 1:-1], atol=1e-12)


@given(st.integers(0, 10**6))
def test_batches_keep_their_own_colours(seed: int) -> None:
    lookup = SkinLookup(SkinReflectance(dtype=D), nodes=(8, 8))
    matrix = torch.rand(3, 33, 3, generator=torch.Generator().manual_seed(seed), dtype=D)
    f_mel, f_blood = maps(3, 4, 5, seed=seed)
    together = lookup.sample(lookup.colours(matrix), f_mel, f_blood)
    for i in range(3):
        alone = lookup.sample(
            lookup.colours(matrix[i : i + 1]), f_mel[i : i + 1], f_blood[i : i + 1]
        )
        assert torch.allclose(together[i], alone[0], atol=1e-14)


@pytest.mark.parametrize("corner", [(0, 0), (0, 1), (1, 0), (1, 1), (0.05, 0.04), (1, 1e-6)])
def test_gradients_are_right_to_the_edges(corner: tuple[float, float]) -> None:
    lookup = SkinLookup(SkinReflectance(dtype=D))
    matrix = torch.rand(1, 33, 3, dtype=D, generator=torch.Generator().manual_seed(0))
    f_mel, f_blood = (torch.full((1, 1, 1), value, dtype=D) for value in corner)

    def sample(matrix: torch.Tensor, *f: torch.Tensor) -> torch.Tensor:
        return lookup.sample(lookup.colours(matrix), *f)

    def closed_form(f_mel: torch.Tensor, f_blood: torch.Tensor) -> torch.Tensor:
        return (lookup.reflectance.bands(f_mel, f_blood) @ matrix[0]).movedim(-1, -3)

    assert torch.autograd.gradcheck(
        lambda matrix: sample(matrix, f_mel, f_blood), matrix.clone().requires_grad_()
    )
    ours, exact = (
        torch.autograd.functional.jacobian(colour, (f_mel, f_blood))
        for colour in (lambda *f: sample(matrix, *f), closed_form)
    )
    for mine, true in zip(ours, exact, strict=True):
        assert (mine - true).norm() < 0.01 * true.norm()


def test_table_is_stored_and_refreshed() -> None:
    lookup = SkinLookup(SkinReflectance(dtype=D))
    assert lookup.spectra() is lookup.spectra() and "table" not in lookup.state_dict()
    lookup.reflectance.d_epd.fill_(0.05)
    lookup.refresh()
    expected = SkinLookup(SkinReflectance(thick(), dtype=D)).spectra()
    assert torch.allclose(lookup.spectra(), expected, atol=1e-6)


def test_trainable_constants_make_the_table_on_every_call() -> None:
    constant = nn.Parameter(torch.tensor(0.021, dtype=D))
    decoder = SkinDecoder(SkinOptics.preset("measured", d_epd=constant), dtype=D)
    with torch.no_grad():
        constant.fill_(0.05)
    # The nodes stay where the first value put them, so the two tables differ by their error.
    expected = SkinDecoder(thick(), dtype=D)
    assert torch.allclose(decoder(*maps(4, 4)), expected(*maps(4, 4)), atol=5e-4)
    with torch.no_grad():
        assert torch.allclose(decoder(*maps(4, 4)), expected(*maps(4, 4)), atol=5e-4)


@pytest.mark.parametrize("assign", [True, False])
@pytest.mark.parametrize("inside", [True, False])
def test_loading_refreshes_the_table(assign: bool, inside: bool) -> None:
    source, target = SkinDecoder(thick(), dtype=D), SkinDecoder(dtype=D)
    before = target(*maps(4, 4))
    if inside:
        nn.Sequential(target).load_state_dict(nn.Sequential(source).state_dict(), assign=assign)
    else:
        target.load_state_dict(source.state_dict(), assign=assign)
    after = target(*maps(4, 4))
    assert torch.equal(after, source(*maps(4, 4))) and not torch.equal(after, before)


def test_loading_into_a_copy_refreshes_its_table() -> None:
    source, target = SkinDecoder(thick(), dtype=D), copy.deepcopy(SkinDecoder(dtype=D))
    target.load_state_dict(source.state_dict())
    assert torch.equal(target(*maps(4, 4)), source(*maps(4, 4)))


def test_freezing_a_trained_constant_keeps_its_value() -> None:
    constant = nn.Parameter(torch.tensor(0.021, dtype=D))
    decoder = SkinDecoder(SkinOptics.preset("measured", d_epd=constant), dtype=D)
    with torch.no_grad():
        constant.fill_(0.05)
    trained = decoder(*maps(4, 4)).detach()
    assert torch.allclose(decoder.requires_grad_(False)(*maps(4, 4)), trained)


def test_decoder_pickles() -> None:
    decoder = SkinDecoder(dtype=D)
    assert torch.equal(pickle.loads(pickle.dumps(decoder))(*maps(4, 4)), decoder(*maps(4, 4)))
