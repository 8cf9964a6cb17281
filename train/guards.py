"""Stops a training whose losses or weights are not finite."""

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import torch
from lightning import Callback, LightningModule, Trainer
from lightning.pytorch.trainer.states import TrainerFn
from torch import Tensor

from skinnet.errors import InputError


class FiniteGuard(Callback):
    """Raises `InputError` for losses and weights that are not finite.

    A loss is checked before the weights take a step with it, and weights are checked before a
    checkpoint is written. All processes share the logged losses, so that all of them
    stop.

    Args:
        find_last: Finds the last good checkpoint of the run; None if there is none yet.
    """

    def __init__(self, find_last: Callable[[], Path | None]) -> None:
        self.find_last = find_last

    def on_before_backward(
        self, trainer: Trainer, pl_module: LightningModule, loss: Tensor
    ) -> None:
        """Check the training losses."""
        self._check(trainer, pl_module, "train/")

    def on_validation_end(self, trainer: Trainer, pl_module: LightningModule) -> None:
        """Check the validation loss of a training."""
        if trainer.state.fn == TrainerFn.FITTING:
            self._check(trainer, pl_module, "val/loss")

    def on_save_checkpoint(
        self, trainer: Trainer, pl_module: LightningModule, checkpoint: dict[str, Any]
    ) -> None:
        """Check the weights."""
        if broken := find_not_finite(checkpoint["state_dict"]):
            raise InputError(self._explain(trainer, "weights", broken))

    def _check(self, trainer: Trainer, pl_module: LightningModule, prefix: str) -> None:
        logged = trainer.callback_metrics
        losses = {name: value for name, value in logged.items() if name.startswith(prefix)}
        if broken := find_not_finite(losses):
            # Weights that are not finite spoil every loss, so the message names the weights.
            weights = find_not_finite(dict(pl_module.named_parameters()))
            what = "weights" if weights else "losses"
            raise InputError(self._explain(trainer, what, weights or broken))

    def _explain(self, trainer: Trainer, what: str, names: list[str]) -> str:
        if (last := self.find_last()) is not None:
            remedy = (
                f"Go on from the last good checkpoint with --ckpt-path {last} and "
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
            f"{list_names(names, 5)}. {remedy}"
        )


def find_not_finite(values: Mapping[str, Tensor]) -> list[str]:
    """Return the names of floating-point tensors with an entry that is infinite or NaN."""
    floating = {name: value for name, value in values.items() if value.is_floating_point()}
    if not floating:
        return []
    # One transfer from the device for all of them.
    finite = torch.stack([value.detach().isfinite().all() for value in floating.values()]).tolist()
    return [name for name, good in zip(floating, finite, strict=True) if not good]


def list_names(names: list[str], most: int) -> str:
    """Write the first names, and how many more there are."""
    more = len(names) - most
    return ", ".join(names[:most]) + (f" and {more} more" if more > 0 else "")
