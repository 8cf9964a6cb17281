"""The numbers that training logs, and the callbacks that watch one of them."""

from dataclasses import fields
from typing import Any

from jsonargparse import Namespace
from lightning import Callback, LightningDataModule, Trainer
from lightning.pytorch.callbacks import EarlyStopping, ModelCheckpoint

from skinnet.errors import InputError
from train.beside_synthetic import BesideSynthetic
from train.fitted import FittedFaces
from train.metrics import PIGMENTS
from train.pairs import PortraitPairs
from train.synthetic.faces import SyntheticFaces
from train.task import KINDS
from train.task_losses import LossWeights

_LOSSES = [field.name for field in fields(LossWeights)]
_FIRST, _LAST = _LOSSES.index("mask"), _LOSSES.index("uncertainty") + 1
_WITH_TRUTH = _LOSSES[:_LAST]
_OF_PEOPLE = ["agreement", "prediction", "agreement_uncertainty"]
_WITHOUT_TRUTH = _LOSSES[:_FIRST] + [one for one in _LOSSES[_LAST:] if one not in _OF_PEOPLE]
_METRICS = ["reconstruction", "mask_iou"]
_PIGMENT_METRICS = [f"{name}{kind}" for name in PIGMENTS for kind in ("", "_r", "_constant")]


def list_logged(data: LightningDataModule) -> set[str] | None:
    """List the names that a monitor may have in a training on these data.

    Args:
        data: The data module.

    Returns:
        The names; None for data of the user, which may be of any kind.
    """
    if not isinstance(data, FittedFaces | BesideSynthetic | SyntheticFaces):
        return None
    names = {"train/loss", "val/loss"}
    names |= {f"train/{KINDS[0]}_{loss}" for loss in _WITH_TRUTH}
    names |= {f"val/{KINDS[0]}_{metric}" for metric in _METRICS + _PIGMENT_METRICS}
    if isinstance(data, PortraitPairs):
        names |= {f"train/{KINDS[1]}_{loss}" for loss in _OF_PEOPLE}
    if isinstance(data, BesideSynthetic):
        names |= {f"train/{KINDS[1]}_{loss}" for loss in _WITHOUT_TRUTH}
        names |= {f"val/{KINDS[1]}_{metric}" for metric in _METRICS}
    return names


def check_monitors(trainer: Trainer, scheduler: Any, logged: set[str] | None) -> None:
    """Check the monitors of callbacks, which Lightning misses only after the first epoch.

    Args:
        trainer: A new trainer.
        scheduler: The user's own scheduler of the learning rate; None: there is none.
        logged: Names that the model logs; None if they are not known.

    Raises:
        InputError: For a monitor that nothing logs, or that only validation logs where there is
            none.
    """
    callbacks: list[Callback] = trainer.callbacks  # type: ignore[attr-defined]
    # Callbacks of the user may log other names.
    ours = all(type(each).__module__.startswith(("lightning.", "train.")) for each in callbacks)
    if not ours or logged is None:
        return
    # The project's own best.ckpt may be left out.
    others = [each for each in callbacks if each is not trainer.checkpoint_callback]
    monitors = [(type(each).__name__, _find_monitor(each)) for each in others]
    if isinstance(scheduler, Namespace) and (arguments := scheduler.get("init_args")) is not None:
        monitors.append(("lr_scheduler", arguments.get("monitor")))
    for name, monitor in monitors:
        if monitor is not None:
            _check_monitor(trainer, f"{name} has the monitor {monitor}", monitor, logged)


def _check_monitor(trainer: Trainer, subject: str, monitor: str, logged: set[str]) -> None:
    if monitor not in logged and not monitor.startswith("lr-"):
        raise InputError(f"{subject}, which is not logged; give one of {_list(logged)}.")
    if monitor.startswith("val/") and trainer.limit_val_batches == 0:
        raise InputError(
            f"{subject} and --trainer.limit_val_batches is 0, so that nothing is validated; give "
            "more batches or another monitor."
        )


def _find_monitor(callback: Callback) -> str | None:
    """What a callback cannot do without; None if there is nothing."""
    if isinstance(callback, EarlyStopping):
        return callback.monitor if callback.strict else None
    return callback.monitor if isinstance(callback, ModelCheckpoint) else None


def _list(names: set[str]) -> str:
    first = ("val/loss", "train/loss")
    return ", ".join((*first, *sorted(names - set(first))))
