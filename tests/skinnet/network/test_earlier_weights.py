"""Files of format 3 give the same maps as before, and the largest uncertainty."""

from pathlib import Path

import pytest
import torch
from safetensors import safe_open

from skinnet.network import SkinAutoencoder
from skinnet.network._earlier_weights import _EARLIER_NAMES, free_uncertainty
from skinnet.network.autoencoder import LOG_SD_RANGE
from skinnet.physics import Capture

BENCHMARKS = Path(__file__).parents[3] / "benchmarks"
FOURTH = BENCHMARKS / "fourth.safetensors"
KNOWN = (0.0741604, 0.0235844, 0.0033637, 0.0049089, 0.0947526, 0.1227065)
"""Means of melanin, hemoglobin, shading and mask, and the white balance, by the network before."""


@pytest.mark.parametrize("file", ["stage1.safetensors", "fourth.safetensors"])
def test_weights_are_renamed(file: str) -> None:
    with safe_open(BENCHMARKS / file, framework="pt") as opened:
        earlier = {name: opened.get_tensor(name).float() for name in opened.keys()}
    assert all(any(f".{old}" in name for name in earlier) for old in _EARLIER_NAMES)
    state = SkinAutoencoder.from_pretrained(BENCHMARKS / file).encoder.state_dict()
    for old, present in (
        ("gather.look.weight", "pooling.conv.weight"),
        ("gather.attend.bias", "pooling.attention.bias"),
        ("gather.expect.weight", "pooling.expected_chroma.weight"),
        ("scene.0.weight", "context.0.weight"),
        ("weigh.2.bias", "refine.2.bias"),
        ("head.mixed.0.running_var", "head.norm.0.running_var"),
        ("stem.0.0.weight", "stem.0.0.weight"),
    ):
        assert torch.equal(state[present], earlier[f"encoder.{old}"])
    assert torch.equal(state["white_balance.weight"][:-2], earlier["encoder.balanced.weight"])


@torch.no_grad()
def test_maps_are_those_of_the_fourth_edition() -> None:
    torch.manual_seed(0)
    photograph = torch.rand(1, 3, 48, 40)
    maps, capture, uncertainty = SkinAutoencoder.from_pretrained(FOURTH).encode(photograph)
    found = [one.mean().item() for one in (maps.melanin, maps.hemoglobin, maps.shading, maps.mask)]
    assert found == pytest.approx(KNOWN[:4], rel=1e-4)
    assert capture.white_balance[0].tolist() == pytest.approx(KNOWN[4:], abs=1e-4)
    for spread in uncertainty:
        torch.testing.assert_close(spread, torch.full_like(spread, LOG_SD_RANGE[1]))


@torch.no_grad()
def test_it_reads_a_balanced_photograph_as_one_that_needs_no_balance() -> None:
    model, photograph = SkinAutoencoder.from_pretrained(FOURTH), torch.rand(1, 3, 48, 40)
    known = Capture(white_balance=torch.zeros(1, 2))
    plain, told = model.encode(photograph), model.encode(photograph, known)
    torch.testing.assert_close(plain[0].melanin, told[0].melanin, rtol=1e-3, atol=1e-5)


@torch.no_grad()
def test_training_starts_with_an_uncertainty_that_has_a_gradient() -> None:
    model = SkinAutoencoder.from_pretrained(FOURTH)
    before = model.encode(torch.rand(1, 3, 32, 32))
    model.encoder.load_state_dict(free_uncertainty(model.encoder.state_dict()))
    after = model.encode(torch.rand(1, 3, 32, 32))
    assert before[2].face.min() > 1.4 and 0.1 < after[2].face.max() < 0.2
    freed = free_uncertainty(model.encoder.state_dict())
    assert all(torch.equal(freed[name], one) for name, one in model.encoder.state_dict().items())
