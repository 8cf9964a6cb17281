"""Writes checkpoints that survive a kill, and pictures of readings."""

import sys
import time
from io import BytesIO
from pathlib import Path
from typing import Any

import torch
from jaxtyping import Float
from lightning import Callback, LightningModule, Trainer
from lightning.pytorch.callbacks import ModelCheckpoint
from lightning.pytorch.loggers import TensorBoardLogger
from lightning.pytorch.plugins.io import TorchCheckpointIO
from lightning.pytorch.utilities import rank_zero_only
from PIL import Image
from torch import Tensor

from skinnet.files import write_atomically
from skinnet.images._mark import Mark
from skinnet.network import F_BLOOD_MAX, F_MEL_MAX, Reading
from skinnet.physics import to_display
from train.batch import Batch
from train.task import Batches, name_batches


class WholeCheckpoints(TorchCheckpointIO):
    """Writes every checkpoint completely or not at all.

    Lightning writes into the file itself, which a kill or a full disk then leaves cut short.
    """

    def save_checkpoint(
        self, checkpoint: dict[str, Any], path: str | Path, storage_options: Any = None
    ) -> None:
        """Write a checkpoint beside its place, and rename it."""
        target = Path(path)
        target.parent.mkdir(parents=True, exist_ok=True)
        content = BytesIO()  # torch's own writer does not say that a disk is full
        torch.save(checkpoint, content)
        with write_atomically(target) as part:
            part.write_bytes(content.getbuffer())


class LastCheckpoint(Callback):
    """Writes `last.ckpt` after every epoch, at intervals, and at the last step.

    Args:
        folder: Folder of the run.
        seconds: Time between checkpoints within an epoch.
    """

    def __init__(self, folder: str, seconds: float = 60.0) -> None:
        self.path = Path(folder) / "last.ckpt"
        self.seconds = seconds
        self.saved = time.monotonic()

    def on_train_batch_end(self, trainer: Trainer, *_: Any) -> None:
        """Write a checkpoint if it is time for one."""
        late = time.monotonic() - self.saved >= self.seconds
        # Clocks differ between processes, and saving needs all of them.
        late = trainer.strategy.reduce_boolean_decision(late, all=False)
        if late or trainer.global_step == trainer.max_steps:
            self._save(trainer)

    def on_train_epoch_end(self, trainer: Trainer, pl_module: LightningModule) -> None:
        """Write a checkpoint after a whole epoch."""
        # Lightning counts an interrupted epoch as done; resuming would skip the rest of it.
        if trainer.is_last_batch:
            self._save(trainer)

    def _save(self, trainer: Trainer) -> None:
        trainer.save_checkpoint(self.path, weights_only=False)
        self.saved = time.monotonic()


def make_best_checkpoint(folder: str) -> ModelCheckpoint:
    """Make the callback that writes `best.ckpt`, which has the lowest loss in validation."""
    return ModelCheckpoint(
        folder,
        "best",
        monitor="val/loss",
        enable_version_counter=False,
        save_on_train_epoch_end=False,
    )


@rank_zero_only
def report_best(trainer: Trainer) -> None:
    """Print that a training has left no `best.ckpt`, if so."""
    best = trainer.checkpoint_callback
    if isinstance(best, ModelCheckpoint) and not best.best_model_path:
        print(
            f"train: There was no validation, so that {best.dirpath} has no best.ckpt.",
            file=sys.stderr,
        )


class PictureGrid(Callback):
    """Writes a picture after every validation, with a row for each portrait.

    Columns are input, melanin, hemoglobin, shading, specular, mask, offset and reconstruction. The
    truth, where there is any, stands below the prediction.

    Args:
        folder: Folder of the run.
        portraits: Number of portraits in the picture.
    """

    def __init__(self, folder: str, portraits: int = 6) -> None:
        self.folder = Path(folder) / "pictures"
        self.portraits = portraits

    def on_validation_batch_end(
        self, trainer: Trainer, pl_module: LightningModule, outputs: Any, batch: Batches,
        batch_idx: int, dataloader_idx: int = 0,
    ) -> None:  # fmt: skip
        """Write the picture of the first batch."""
        if batch_idx or trainer.sanity_checking or not trainer.is_global_zero:
            return
        parts = name_batches(batch)
        count = max(self.portraits // len(parts), 1)
        picture = torch.cat(
            [draw_grid(outputs[name], part, count) for name, part in parts.items()], 1
        )
        self.folder.mkdir(parents=True, exist_ok=True)
        pixels = (picture.permute(1, 2, 0) * 255).round().byte().cpu().numpy()
        mark = Mark("fit", "pictures").to_png_info()  # they are no photographs to train on
        path = self.folder / f"step_{trainer.global_step:06d}.png"
        with write_atomically(path) as part:
            Image.fromarray(pixels).save(part, pnginfo=mark)
        for logger in trainer.loggers:
            if isinstance(logger, TensorBoardLogger):
                logger.experiment.add_image("portraits", picture, trainer.global_step)


@torch.no_grad()
def draw_grid(reading: Reading, batch: Batch, portraits: int) -> Float[Tensor, "3 height width"]:
    """Draw the first portraits of a batch, in display sRGB."""
    rows = [_draw_row(batch.photograph, reading.maps, reading.reconstruction)]
    if batch.truth is not None:
        rows.append(
            _draw_row(batch.photograph, batch.truth, torch.zeros_like(reading.reconstruction))
        )
    count = min(portraits, len(batch.photograph))
    return torch.cat([row[index] for index in range(count) for row in rows], 1).float()


def _draw_row(
    photograph: Tensor, maps: Any, reconstruction: Tensor
) -> Float[Tensor, "batch 3 height width"]:
    columns = [
        photograph,
        _to_grey(maps.melanin / F_MEL_MAX),
        _to_grey(maps.hemoglobin / F_BLOOD_MAX),
        _to_grey(maps.shading / 1.5),
        _to_grey(maps.specular / 0.3),
        _to_grey(maps.mask),
        to_display(maps.offset),
        to_display(reconstruction),
    ]
    return torch.cat(columns, -1)


def _to_grey(value: Tensor) -> Tensor:
    return value.clamp(0, 1).sqrt()[:, None].expand(-1, 3, -1, -1)
