"""Synthetic portraits with all ground truth: the default data, which needs no download."""

from functools import partial
from typing import Any

import numpy as np
from jsonargparse.typing import NonNegativeInt, PositiveInt
from lightning import LightningDataModule, Trainer
from torch import Tensor
from torch.utils.data import DataLoader, Dataset

from skinnet.decoder import SkinDecoder
from train.batch import Batch
from train.render import render
from train.scene import Scene, draw_scene
from train.stream import StreamLoader

_SPLITS = {"train": 0, "val": 1, "test": 2}


class Scenes(Dataset[Scene]):
    """Scenes drawn from (seed, split, index), the same on every machine."""

    def __init__(self, split: str, samples: int, size: int, seed: int):
        self.key = (seed, _SPLITS[split])
        self.samples = samples
        self.size = size

    def __len__(self) -> int:
        return self.samples

    def __getitem__(self, index: int) -> Scene:
        return draw_scene(np.random.default_rng([*self.key, index]), self.size)


class SyntheticFaces(LightningDataModule):
    """Procedural faces with varied skin, light, camera and exposure.

    Scenes are drawn by the loader and rendered on the device that trains. Training never repeats
    one; validation and test see the same ones on every run.

    Args:
        size: side of the square pictures in pixels.
        batch_size: pictures in a batch of each process.
        train_samples: pictures that are called an epoch.
        val_samples: pictures of the validation set.
        test_samples: pictures of the test set.
        seed: of all scenes.
        workers: processes that draw scenes; 0 draws them in the training process.
    """

    def __init__(
        self,
        size: PositiveInt = 128,
        batch_size: PositiveInt = 32,
        train_samples: PositiveInt = 6400,
        val_samples: PositiveInt = 128,
        test_samples: PositiveInt = 256,
        seed: NonNegativeInt = 0,
        workers: NonNegativeInt = 0,
    ):
        super().__init__()
        self.size = size
        self.batch_size = batch_size
        self.samples = {"train": train_samples, "val": val_samples, "test": test_samples}
        self.seed = seed
        self.workers = workers
        self.decoder = SkinDecoder()

    @property
    def described(self) -> str:
        """What a model card says of these data."""
        return f"synthetic faces of skinnet, seed {self.seed}, {self.size} px"

    def train_dataloader(self) -> StreamLoader:
        return self.stream(self.samples["train"] // self.batch_size, self.trainer)

    def stream(self, steps: int, trainer: Trainer | None) -> StreamLoader:
        """Training scenes in epochs of that many steps, from where the trainer stands."""
        samples = max(steps, 1) * self.batch_size
        scenes = Scenes("train", samples, self.size, self.seed)
        seen = partial(seen_samples, trainer, self.batch_size)
        return StreamLoader(scenes, self.batch_size, samples, seen, self.workers)

    def val_dataloader(self) -> DataLoader[Scene]:
        return self._fixed("val")

    def test_dataloader(self) -> DataLoader[Scene]:
        return self._fixed("test")

    def on_after_batch_transfer(self, batch: Any, dataloader_idx: int) -> Batch:
        scenes: dict[str, Tensor] = batch
        return render(scenes, self.decoder.to(scenes["f_mel"].device))

    def _fixed(self, split: str) -> DataLoader[Scene]:
        scenes = Scenes(split, self.samples[split], self.size, self.seed)
        return DataLoader(scenes, self.batch_size, num_workers=self.workers)


def seen_samples(trainer: Trainer | None, batch_size: int) -> int:
    """Samples that this process has trained on, over all epochs and interruptions."""
    if trainer is None:
        return 0
    return int(trainer.global_step * trainer.accumulate_grad_batches * batch_size)
