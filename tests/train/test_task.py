"""Training makes the reading better."""

import numpy as np
import torch

from skinnet.decoder import SkinDecoder
from train.batch import Batch
from train.render import render
from train.synthetic import Scenes
from train.task import LossWeights, SkinTask, one_cycle, terms


def batch(count: int) -> Batch:
    drawn = [Scenes("train", count, 32, seed=0)[index] for index in range(count)]
    stacked = {name: torch.from_numpy(np.stack([d[name] for d in drawn])) for name in drawn[0]}
    return render(stacked, SkinDecoder())


def test_a_few_steps_lower_the_loss() -> None:
    torch.manual_seed(0)
    task, data = SkinTask(widths=[8, 16, 24]), batch(4)
    optimizer = torch.optim.Adam(task.parameters(), 5e-3)
    found = []
    for _ in range(25):
        _, loss, _ = task._losses(data)
        optimizer.zero_grad()
        loss.backward()
        optimizer.step()
        found.append(float(loss.detach()))
    assert found[-1] < 0.6 * found[0]


def test_every_loss_has_a_weight_and_every_weight_a_loss() -> None:
    task, data = SkinTask(widths=[4, 8]), batch(2)
    assert set(terms(task(data.photograph), data)) == set(LossWeights.__dataclass_fields__)


def test_photographs_without_truth_have_no_supervised_losses() -> None:
    task, data = SkinTask(widths=[4, 8]), batch(2)
    found = terms(task(data.photograph), Batch(data.photograph, data.mask))
    assert {"pigments", "lighting", "white_balance"}.isdisjoint(found)


def test_the_learning_rate_rises_and_falls_to_zero() -> None:
    rates = [one_cycle(step, 10, 100) for step in range(101)]
    assert max(rates) == 1.0 and rates[0] < 0.2 and rates[-1] == 0.0
