"""What runs in the processes of a distributed run, which a test cannot reach into."""

import json
import sys
from collections.abc import Sequence
from pathlib import Path

import torch
from lightning import Callback, LightningModule, Trainer
from torch import Tensor, distributed, nn

from skinnet.network import Reading, SkinMaps, Uncertainty
from skinnet.physics import SpectralCamera
from train.batch import Batch
from train.metrics import ReadingMetrics
from train.synthetic.faces import SyntheticScenes


class _Sum(torch.autograd.Function):
    """Sum over all processes; so is its gradient."""

    @staticmethod
    def forward(ctx: object, value: Tensor) -> Tensor:
        value = value.clone()
        distributed.all_reduce(value)
        return value

    @staticmethod
    def backward(ctx: object, gradient: Tensor) -> Tensor:
        return _Sum.forward(ctx, gradient)


class SharedBatchNorm(nn.BatchNorm2d):
    """Batch statistics over all processes, as `--trainer.sync_batchnorm true` has them on GPUs.

    torch's SyncBatchNorm refuses tensors on a CPU.
    """

    def forward(self, x: Tensor) -> Tensor:
        if not self.training:
            return super().forward(x)
        count = distributed.get_world_size()
        moments = torch.stack([x.mean((0, 2, 3)), (x**2).mean((0, 2, 3))])
        mean, square = _Sum.apply(moments) / count
        variance = square - mean**2
        samples = count * x.numel() / x.shape[1]
        with torch.no_grad():
            self.running_mean.lerp_(mean, self.momentum)
            self.running_var.lerp_(variance * samples / (samples - 1), self.momentum)
        scale = self.weight * (variance + self.eps).rsqrt()
        return (x - mean[:, None, None]) * scale[:, None, None] + self.bias[:, None, None]


class Witness(Callback):
    """Notes the training scenes that each process samples, in `folder`/RANK.txt.

    Args:
        folder: of the notes.
        break_at: the step from which the process of rank 1 has photographs that are no numbers.
    """

    def __init__(self, folder: str, break_at: int | None = None):
        self.folder, self.break_at = Path(folder), break_at

    def setup(self, trainer: Trainer, pl_module: LightningModule, stage: str) -> None:
        for module in pl_module.modules():
            if type(module) is nn.BatchNorm2d:
                module.__class__ = SharedBatchNorm
        sample, notes = SyntheticScenes.__getitem__, self.folder / f"{trainer.global_rank}.txt"

        def sample_and_note(scenes: SyntheticScenes, index: int) -> object:
            if scenes.key[1] == 0:
                with notes.open("a") as file:
                    file.write(f"{index}\n")
            return sample(scenes, index)

        SyntheticScenes.__getitem__ = sample_and_note  # type: ignore[method-assign]

    def on_train_batch_start(
        self, trainer: Trainer, pl_module: LightningModule, batch: object, batch_idx: int
    ) -> None:
        if trainer.global_rank == 1 and trainer.global_step == self.break_at:
            batch.photograph.fill_(float("nan"))  # type: ignore[attr-defined]


def measure(seeds: Sequence[int]) -> dict[str, float]:
    """Metrics of random readings of random pictures, one batch for each seed."""
    metrics = ReadingMetrics()
    for seed in seeds:
        rng = torch.Generator().manual_seed(seed)
        count = 1 + 2 * seed
        maps = [0.1 * torch.rand(2, count, 8, 8, generator=rng) for _ in range(5)]
        guess, truth = (
            SkinMaps(*(one[i] for one in maps[:4]), torch.zeros(count, 3, 8, 8), 8 * maps[4][i])
            for i in range(2)
        )
        photograph, made = torch.rand(2, count, 3, 8, 8, generator=rng)
        capture = SpectralCamera().standard((count,))
        spread = Uncertainty(guess.melanin, guess.hemoglobin, torch.ones(count, 2))
        reading = Reading(guess, capture, made, spread)
        metrics.update(reading, Batch(photograph, truth.mask, truth, capture))
    return {name: metric.compute().item() for name, metric in metrics.metrics.items()}


if __name__ == "__main__":
    rank = int(sys.argv[2])
    distributed.init_process_group(
        "gloo", init_method=f"file://{sys.argv[1]}", rank=rank, world_size=2
    )
    print(json.dumps(measure([rank])))
    distributed.destroy_process_group()
