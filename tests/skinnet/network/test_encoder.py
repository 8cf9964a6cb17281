"""Attention pooling, confidence-weighted voting, and the names of weights."""

from pathlib import Path

import pytest
import torch
from safetensors import safe_open

from skinnet.network import SkinAutoencoder
from skinnet.network.encoder import _EARLIER_NAMES, _POOLED_COLOURS, _AttentionPooling

STAGE1 = Path(__file__).parents[3] / "benchmarks" / "stage1.safetensors"


def make_pooling() -> _AttentionPooling:
    torch.manual_seed(0)
    pooling = _AttentionPooling(4)
    torch.nn.init.zeros_(pooling.expected_chroma.weight)
    torch.nn.init.zeros_(pooling.expected_chroma.bias)
    return pooling


def test_a_picture_of_one_colour_votes_for_its_own_tint() -> None:
    log = torch.tensor([-1.0, -1.2, -1.5])[None, :, None, None].expand(2, 3, 12, 10)
    colours, tint = make_pooling()(torch.rand(2, 4, 6, 5), log)
    expected = log[:, None, :, 0, 0].expand(2, _POOLED_COLOURS, 3)
    torch.testing.assert_close(colours.reshape(2, _POOLED_COLOURS, 3), expected)
    torch.testing.assert_close(tint, torch.tensor([[2.0, -3.0]]).expand(2, 2))


def test_the_expected_chroma_is_subtracted() -> None:
    pooling = make_pooling()
    with torch.no_grad():
        pooling.expected_chroma.bias += torch.tensor([0.5, -0.25])
    _, tint = pooling(torch.rand(1, 4, 6, 5), torch.zeros(1, 3, 12, 10))
    torch.testing.assert_close(tint, torch.tensor([[-0.5, 0.25]]))


def test_gradients_of_the_tint_are_finite() -> None:
    log = torch.zeros(1, 3, 12, 10, requires_grad=True)
    _, tint = _AttentionPooling(4)(torch.rand(1, 4, 6, 5), log)
    (gradient,) = torch.autograd.grad(tint.sum(), log)
    assert gradient.isfinite().all() and gradient.any()


@pytest.mark.parametrize("prefix", ["", "model."])
def test_weights_of_earlier_files_are_renamed(prefix: str) -> None:
    with safe_open(STAGE1, framework="pt") as file:
        earlier = {prefix + name: file.get_tensor(name).float() for name in file.keys()}
    assert all(any(f".{old}" in name for name in earlier) for old in _EARLIER_NAMES)
    names, model = set(earlier), SkinAutoencoder()
    holder = torch.nn.ModuleDict({"model": model}) if prefix else model
    holder.load_state_dict(earlier)
    assert set(earlier) == names  # the caller's dict is left alone
    state = model.encoder.state_dict()
    for old, today in (
        ("gather.look.weight", "pooling.conv.weight"),
        ("gather.attend.bias", "pooling.attention.bias"),
        ("gather.expect.weight", "pooling.expected_chroma.weight"),
        ("scene.0.weight", "context.0.weight"),
        ("weigh.2.bias", "refine.2.bias"),
        ("balanced.weight", "white_balance.weight"),
        ("head.mixed.0.running_var", "head.norm.0.running_var"),
        ("stem.0.0.weight", "stem.0.0.weight"),
    ):
        assert torch.equal(state[today], earlier[f"{prefix}encoder.{old}"])
    again = SkinAutoencoder()
    again.load_state_dict(model.state_dict())
    assert torch.equal(again.encoder.refine[2].bias, model.encoder.refine[2].bias)
