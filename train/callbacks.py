"""Checkpoints that survive a kill, and pictures of what the model sees."""

import time
from pathlib import Path
from typing import Any

import torch
from jaxtyping import Float
from lightning import Callback, LightningModule, Trainer
from lightning.pytorch.loggers import TensorBoardLogger
from PIL import Image
from torch import Tensor

from skinnet.network import F_BLOOD_MAX, F_MEL_MAX, Reading
from skinnet.physics import to_display
from train.batch import Batch
from train.task import Batches, name_batches


class LastCheckpoint(Callback):
    """Keeps `last.ckpt`: after every epoch, every so many seconds, and at the last step."""

    def __init__(self, folder: str, seconds: float = 60.0):
        self.path = Path(folder) / "last.ckpt"
        self.seconds = seconds
        self.saved = time.monotonic()

    def on_train_batch_end(self, trainer: Trainer, *_: Any) -> None:
        late = time.monotonic() - self.saved >= self.seconds
        # Clocks differ between processes, and all of them must come to save.
        late = trainer.strategy.reduce_boolean_decision(late, all=False)
        if late or trainer.global_step == trainer.max_steps:
            self._save(trainer)

    def on_train_epoch_end(self, trainer: Trainer, pl_module: LightningModule) -> None:
        # An epoch cut short counts as done from here on; resuming would skip the rest of it.
        if trainer.is_last_batch:
            self._save(trainer)

    def _save(self, trainer: Trainer) -> None:
        # Renamed into place: a kill while writing leaves the checkpoint before.
        beside = self.path.with_name(".last.ckpt.part")
        trainer.save_checkpoint(beside, weights_only=False)
        if trainer.is_global_zero:
            beside.replace(self.path)
        self.saved = time.monotonic()


class PictureGrid(Callback):
    """A picture after every validation: a row a portrait, from the input to its reconstruction.

    Columns: input, melanin, hemoglobin, shading, specular, mask, offset, reconstruction; truth,
    where there is any, stands below the prediction.
    """

    def __init__(self, folder: str, portraits: int = 6):
        self.folder = Path(folder) / "pictures"
        self.portraits = portraits

    def on_validation_batch_end(
        self, trainer: Trainer, pl_module: LightningModule, outputs: Any, batch: Batches,
        batch_idx: int, dataloader_idx: int = 0,
    ) -> None:  # fmt: skip
        if batch_idx or trainer.sanity_checking or not trainer.is_global_zero:
            return
        parts = name_batches(batch)
        count = max(self.portraits // len(parts), 1)
        picture = torch.cat([grid(outputs[name], part, count) for name, part in parts.items()], 1)
        self.folder.mkdir(parents=True, exist_ok=True)
        pixels = (picture.permute(1, 2, 0) * 255).round().byte().cpu().numpy()
        Image.fromarray(pixels).save(self.folder / f"step_{trainer.global_step:06d}.png")
        for logger in trainer.loggers:
            if isinstance(logger, TensorBoardLogger):
                logger.experiment.add_image("portraits", picture, trainer.global_step)


@torch.no_grad()
def grid(reading: Reading, batch: Batch, portraits: int) -> Float[Tensor, "3 height width"]:
    """The picture grid of the first portraits of a batch, in display sRGB."""
    rows = [_row(batch.photograph, reading.maps, reading.reconstruction)]
    if batch.truth is not None:
        rows.append(_row(batch.photograph, batch.truth, torch.zeros_like(reading.reconstruction)))
    count = min(portraits, len(batch.photograph))
    return torch.cat([row[index] for index in range(count) for row in rows], 1).float()


def _row(
    photograph: Tensor, maps: Any, reconstruction: Tensor
) -> Float[Tensor, "batch 3 height width"]:
    columns = [
        photograph,
        _grey(maps.melanin / F_MEL_MAX),
        _grey(maps.hemoglobin / F_BLOOD_MAX),
        _grey(maps.shading / 1.5),
        _grey(maps.specular / 0.3),
        _grey(maps.mask),
        to_display(maps.offset),
        to_display(reconstruction),
    ]
    return torch.cat(columns, -1)


def _grey(value: Tensor) -> Tensor:
    return value.clamp(0, 1).sqrt()[:, None].expand(-1, 3, -1, -1)
