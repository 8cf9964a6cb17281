"""Attention pooling, confidence-weighted voting, and what is known of a capture."""

import torch

from skinnet.network import SkinEncoder
from skinnet.network.encoder import _POOLED_COLOURS, _AttentionPooling


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


def test_what_is_known_changes_nothing_before_it_is_trained() -> None:
    torch.manual_seed(0)
    encoder = SkinEncoder(7, 20, (4, 8), known_values=5).eval()
    photograph = torch.rand(2, 3, 16, 16)
    plain, told = encoder(photograph, photograph), encoder(photograph, photograph, torch.rand(2, 5))
    assert torch.equal(plain[0], told[0]) and torch.equal(plain[1], told[1])
