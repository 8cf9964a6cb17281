"""Training makes the reading better."""

from collections.abc import Callable

import torch

from train.batch import Batch
from train.task import LossWeights, SkinTask, compute_losses, warm_up_and_anneal

Make = Callable[[int], Batch]


def test_a_few_steps_lower_the_loss(batch: Make) -> None:
    torch.manual_seed(0)
    task, data = SkinTask(widths=[8, 16, 24]), batch(4)
    optimizer = torch.optim.Adam(task.parameters(), 5e-3)
    found = []
    for _ in range(25):
        _, loss, _ = task._compute_losses(data)
        optimizer.zero_grad()
        loss.backward()
        optimizer.step()
        found.append(float(loss.detach()))
    assert found[-1] < 0.6 * found[0]


def test_every_loss_has_a_weight_and_every_weight_a_loss(batch: Make) -> None:
    task, data = SkinTask(widths=[4, 8]), batch(2)
    without = Batch(data.photograph, data.mask, paired=True)
    found = [set(compute_losses(task(data.photograph), one)) for one in (data, without)]
    assert found[0] | found[1] == set(LossWeights.__dataclass_fields__)


def test_photographs_without_truth_have_no_supervised_losses(batch: Make) -> None:
    task, data = SkinTask(widths=[4, 8]), batch(2)
    found = compute_losses(task(data.photograph), Batch(data.photograph, data.mask))
    known = {
        *("mask", "soft_iou", "pigment_l1", "pigment_mse", "error_shading_covariance"),
        *("lighting", "white_balance"),
    }
    assert known.isdisjoint(found)


def test_the_learning_rate_rises_and_falls_to_zero() -> None:
    rates = [warm_up_and_anneal(step, 10, 100) for step in range(101)]
    assert max(rates) == 1.0 and rates[0] < 0.2 and rates[-1] == 0.0
