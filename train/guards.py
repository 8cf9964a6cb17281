"""What stops a training that can no longer come to anything."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import torch
from lightning import Callback, LightningModule, Trainer
from lightning.pytorch.trainer.states import TrainerFn
from torch import Tensor

from skinnet.errors import InputError


class FiniteGuard(Callback):
    """Raises `InputError` for a loss that is not finite, before the weights take a step with it,
    and for weights that are not, before any checkpoint is written of them.

    Losses are those that are logged, which all processes share, so that all of them stop.
    """

    def __init__(self, folder: str):
        self.last = Path(folder) / "last.ckpt"

    def on_before_backward(
        self, trainer: Trainer, pl_module: LightningModule, loss: Tensor
    ) -> None:
        self._check(trainer, pl_module, "train/")

    def on_validation_end(self, trainer: Trainer, pl_module: LightningModule) -> None:
        if trainer.state.fn == TrainerFn.FITTING:
            self._check(trainer, pl_module, "val/loss")

    def on_save_checkpoint(
        self, trainer: Trainer, pl_module: LightningModule, checkpoint: dict[str, Any]
    ) -> None:
        if broken := not_finite(checkpoint["state_dict"]):
            raise InputError(self._sentence(trainer, "weights", broken))

    def _check(self, trainer: Trainer, pl_module: LightningModule, prefix: str) -> None:
        logged = trainer.callback_metrics
        losses = {name: value for name, value in logged.items() if name.startswith(prefix)}
        if broken := not_finite(losses):
            # Broken weights break every loss; then the weights are what there is to tell.
            weights = not_finite(dict(pl_module.named_parameters()))
            what = "weights" if weights else "losses"
            raise InputError(self._sentence(trainer, what, weights or broken))

    def _sentence(self, trainer: Trainer, what: str, names: list[str]) -> str:
        if self.last.is_file():
            remedy = (
                f"Go on from the last good checkpoint with --ckpt_path {self.last} and "
                "--trainer.gradient_clip_val 1 or --trainer.precision 32-true, or start again "
                "with a lower --model.learning_rate."
            )
        else:
            remedy = (
                "Start again with a lower --model.learning_rate, --trainer.gradient_clip_val 1 or "
                "--trainer.precision 32-true."
            )
        return (
            f"Training stopped at step {trainer.global_step}, where {what} are not finite: "
            f"{listed(names, 5)}. {remedy}"
        )


def not_finite(values: Mapping[str, Tensor]) -> list[str]:
    """Names of the floating-point tensors with an entry that is infinite or not a number."""
    floating = {name: value for name, value in values.items() if value.is_floating_point()}
    if not floating:
        return []
    # One transfer from the device for all of them.
    finite = torch.stack([value.detach().isfinite().all() for value in floating.values()]).tolist()
    return [name for name, good in zip(floating, finite, strict=True) if not good]


def listed(names: list[str], most: int) -> str:
    """The first names, and how many more there are."""
    more = len(names) - most
    return ", ".join(names[:most]) + (f" and {more} more" if more > 0 else "")
