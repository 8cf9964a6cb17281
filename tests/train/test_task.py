"""Training makes the reading better."""

from collections.abc import Callable

import pytest
import torch
from torch.optim.lr_scheduler import CosineAnnealingLR, LinearLR, LRScheduler, SequentialLR

from train.batch import Batch, People
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
    reading = task(data.photograph)
    found = [set(compute_losses(reading, one)) for one in (data, without)]
    people = People(torch.ones_like(data.mask).long(), torch.zeros(2, 3))
    found.append(set(task._compare_people(reading, without, people)))
    assert set.union(*found) == set(LossWeights.__dataclass_fields__)


def test_photographs_without_truth_have_no_supervised_losses(batch: Make) -> None:
    task, data = SkinTask(widths=[4, 8]), batch(2)
    found = compute_losses(task(data.photograph), Batch(data.photograph, data.mask))
    known = {
        *("mask", "soft_iou", "pigment_l1", "pigment_mse", "error_shading_covariance"),
        *("lighting", "white_balance", "uncertainty"),
    }
    assert known.isdisjoint(found)


def test_the_learning_rate_is_that_of_torch_s_schedulers() -> None:
    warmup, steps = 10, 100
    optimizer = torch.optim.SGD([torch.zeros(1, requires_grad=True)], lr=1.0)
    parts: list[LRScheduler] = [
        LinearLR(optimizer, 1 / (warmup + 1), total_iters=warmup),
        CosineAnnealingLR(optimizer, steps - warmup),
    ]
    schedule = SequentialLR(optimizer, parts, [warmup])
    for step in range(steps + 1):
        (rate,) = schedule.get_last_lr()
        assert warm_up_and_anneal(step, warmup, steps) == pytest.approx(rate, abs=1e-12)
        optimizer.step()
        schedule.step()


def test_the_learning_rate_stays_zero_after_the_last_step() -> None:
    assert warm_up_and_anneal(100, 10, 100) == warm_up_and_anneal(120, 10, 100) == 0
    assert warm_up_and_anneal(0, 0, 100) == 1
