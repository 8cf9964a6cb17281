"""The photometric twin as training data: heads ray-cast once, photographed anew on every step."""

from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from jsonargparse.typing import NonNegativeInt, PositiveInt
from lightning import LightningDataModule, Trainer
from numpy.typing import NDArray
from torch import Tensor
from torch.utils.data import DataLoader, Dataset

from skinnet.physics import SkinDecoder
from train.batch import Batch
from train.stream import StreamLoader, count_seen_samples
from train.synthetic.head_cache import SPLITS, geometry
from train.synthetic.head_cast import Buffers
from train.synthetic.model_skins import Skins, draw_skin, load_skins
from train.synthetic.renderer import render
from train.synthetic.scene_sampling import draw_lot

STAGES = {"fit": ("train", "val"), "validate": ("val",), "test": ("test",)}
"""Splits whose heads a stage of training needs."""

Drawn = dict[str, NDArray[Any]]


class Lots(Dataset[Drawn]):
    """Heads with a lot each, drawn from (seed, split, index): the same on every machine.

    Heads take turns, so that a set as large as their number, or a multiple, has each as often. With
    `skins`, half of the pictures wear one; all else in them is what it is without. `wide` lots are
    of training alone.
    """

    def __init__(
        self,
        heads: Drawn,
        split: str,
        samples: int,
        seed: int,
        skins: Skins | None = None,
        wide: bool = False,
    ):
        self.heads, self.samples, self.skins, self.wide = heads, samples, skins, wide
        self.key = (seed, SPLITS[split], 7)

    def __len__(self) -> int:
        return self.samples

    def __getitem__(self, index: int) -> Drawn:
        count, size = self.heads["label"].shape[:2]
        buffers = {name: value[index % count] for name, value in self.heads.items()}
        lot = draw_lot(np.random.default_rng([*self.key, index]), size, self.wide)
        if self.skins is not None:
            # Draws of its own, so that lots are the same with skins and without.
            lot |= draw_skin(np.random.default_rng([*self.key, index, 1]), self.skins)
        return {**buffers, **lot}


class SyntheticFaces(LightningDataModule):
    """Heads with all ground truth under varied skin, light, camera and exposure.

    Their geometry is ray-cast once and kept on disk; everything else is drawn afresh on every step
    and rendered on the device that trains. Training never repeats a picture, and its skin may be
    darker and shine more than theirs; validation and test have heads of their own, the test cameras
    of its own too, and both are the same on every run.

    Args:
        size: side of the square pictures in pixels.
        batch_size: pictures in a batch of each process.
        heads: heads of the training set.
        val_heads: heads of the validation set.
        test_heads: heads of the test set.
        train_samples: pictures that are called an epoch.
        val_samples: pictures of the validation set.
        test_samples: pictures of the test set.
        ict: ICT-FaceKit's model as an .npz; without it all heads are procedural.
        geometry: folder in which the heads are kept.
        skins: .npz of `python -m train.synthetic.skins` or `examples/london.py`, skins drawn from a
            hybrid model; half of the pictures then wear one. Without it skins are painted only.
        seed: of everything that is drawn.
        workers: processes that cast heads and draw pictures; 0 does both in the training process.
    """

    def __init__(
        self,
        size: PositiveInt = 160,
        batch_size: PositiveInt = 32,
        heads: PositiveInt = 800,
        val_heads: PositiveInt = 64,
        test_heads: PositiveInt = 128,
        train_samples: PositiveInt = 6400,
        val_samples: PositiveInt = 128,
        test_samples: PositiveInt = 512,
        ict: str | None = None,
        geometry: str = "runs/geometry",
        skins: str | None = None,
        seed: NonNegativeInt = 0,
        workers: NonNegativeInt = 0,
    ):
        super().__init__()
        self.size, self.batch_size = size, batch_size
        self.heads = {"train": heads, "val": val_heads, "test": test_heads}
        self.samples = {"train": train_samples, "val": val_samples, "test": test_samples}
        self.ict = None if ict is None else Path(ict)
        self.geometry, self.seed, self.workers = Path(geometry), seed, workers
        self.skins_file = None if skins is None else Path(skins)
        self.skins: Skins | None = None
        self.decoder = SkinDecoder()
        self.buffers: dict[str, Drawn] = {}

    @property
    def description(self) -> str:
        """What a model card says of these data."""
        kind = "procedural heads" if self.ict is None else "ICT-FaceKit and procedural heads"
        said = f"{self.heads['train']} {kind} of skinnet's twin, seed {self.seed}, {self.size} px"
        return said if self.skins_file is None else f"{said}, half with skins of {self.skins_file}"

    def prepare_data(self) -> None:
        """Cast the heads that are missing; of several processes on a machine, one does."""
        assert self.trainer is not None and self.trainer.state.fn is not None
        for split in STAGES[self.trainer.state.fn.value]:
            self._cast(split)

    def setup(self, stage: str) -> None:
        """Read the heads that a stage needs, or cast them: fit, validate or test."""
        if self.skins is None and self.skins_file is not None:
            self.skins = load_skins(self.skins_file)
        for split in STAGES[stage]:
            if split not in self.buffers:
                cast = self._cast(split)
                # Torch counts with signed integers; the bits are the same.
                self.buffers[split] = cast._replace(seen=cast.seen.view(np.int64))._asdict()

    def _cast(self, split: str) -> Buffers:
        count, workers = self.heads[split], max(self.workers, 1)
        return geometry(self.geometry, self.size, count, split, self.seed, self.ict, workers)

    def train_dataloader(self) -> StreamLoader:
        return self.stream(self.samples["train"] // self.batch_size, self.trainer)

    def stream(self, steps: int, trainer: Trainer | None) -> StreamLoader:
        """Training pictures in epochs of that many steps, from where the trainer stands."""
        samples = max(steps, 1) * self.batch_size
        lots = Lots(self.buffers["train"], "train", samples, self.seed, self.skins, wide=True)
        seen = partial(count_seen_samples, trainer, self.batch_size)
        return StreamLoader(lots, self.batch_size, samples, seen, self.workers)

    def val_dataloader(self) -> DataLoader[Drawn]:
        return self._fixed("val")

    def test_dataloader(self) -> DataLoader[Drawn]:
        return self._fixed("test")

    def on_after_batch_transfer(self, batch: Any, dataloader_idx: int) -> Batch:
        lot: dict[str, Tensor] = batch
        testing = self.trainer is not None and self.trainer.testing
        return self.render(lot, "test" if testing else "train")

    def render(self, lot: dict[str, Tensor], split: str) -> Batch:
        """Photographs of a batch of lots, with the cameras of a split."""
        return render(lot, self.decoder.to(lot["f_mel"].device), split)

    def _fixed(self, split: str) -> DataLoader[Drawn]:
        lots = Lots(self.buffers[split], split, self.samples[split], self.seed, self.skins)
        return DataLoader(lots, self.batch_size, num_workers=self.workers)
