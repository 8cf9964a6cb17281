"""What the encoder gathers for the scene."""

import torch

from skinnet.network.encoder import GATHERED, _Gather


def gatherer() -> _Gather:
    torch.manual_seed(0)
    gather = _Gather(4)
    torch.nn.init.zeros_(gather.expect.weight)
    torch.nn.init.zeros_(gather.expect.bias)
    return gather


def test_a_picture_of_one_colour_votes_for_its_own_tint() -> None:
    log = torch.tensor([-1.0, -1.2, -1.5])[None, :, None, None].expand(2, 3, 12, 10)
    colours, balance = gatherer()(torch.rand(2, 4, 6, 5), log)
    torch.testing.assert_close(
        colours.reshape(2, GATHERED, 3), log[:, None, :, 0, 0].expand(2, GATHERED, 3)
    )
    torch.testing.assert_close(balance, torch.tensor([[2.0, -3.0]]).expand(2, 2))


def test_the_chroma_that_a_place_should_have_is_taken_off() -> None:
    gather = gatherer()
    with torch.no_grad():
        gather.expect.bias += torch.tensor([0.5, -0.25])
    _, balance = gather(torch.rand(1, 4, 6, 5), torch.zeros(1, 3, 12, 10))
    torch.testing.assert_close(balance, torch.tensor([[-0.5, 0.25]]))


def test_a_tint_of_all_the_picture_leaves_gradients_finite() -> None:
    log = torch.zeros(1, 3, 12, 10, requires_grad=True)
    _, balance = _Gather(4)(torch.rand(1, 4, 6, 5), log)
    (slope,) = torch.autograd.grad(balance.sum(), log)
    assert slope.isfinite().all() and slope.any()
