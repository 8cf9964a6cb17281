"""`python -m train fit | validate | test --config configs/NAME.yaml`."""

import logging
import sys
import warnings
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from lightning import Callback, LightningDataModule, Trainer
from lightning.fabric.utilities.exceptions import MisconfigurationException
from lightning.pytorch.callbacks import (
    LearningRateMonitor,
    ModelCheckpoint,
    RichProgressBar,
    TQDMProgressBar,
)
from lightning.pytorch.cli import LightningArgumentParser, LightningCLI
from lightning.pytorch.loggers import TensorBoardLogger

from skinnet.errors import InputError
from skinnet.network import read_checkpoint
from skinnet.pipeline import SentenceParser
from train.callbacks import LastCheckpoint, PictureGrid
from train.fitted import FittedFaces
from train.guards import FiniteGuard
from train.logs import CurveLogger
from train.portraits import Portraits
from train.synthetic.faces import SyntheticFaces
from train.task import SkinTask

__all__ = ["FittedFaces", "Portraits", "SkinCLI", "SyntheticFaces", "main"]

_RENAMED = {
    "model.losses.elsewhere": "model.losses.background_reconstruction",
    "model.losses.stray": "model.losses.off_skin_shading",
    "model.losses.overlap": "model.losses.soft_iou",
    "model.losses.pigments": "model.losses.pigment_l1",
    "model.losses.fractions": "model.losses.pigment_mse",
    "model.losses.leak": "model.losses.error_shading_covariance",
    "model.losses.steadiness": "model.losses.augmentation_consistency",
    "TwinFaces": "SyntheticFaces",
    "twin": "synthetic",
}
"""Keys and classes of version 0.1, and their present names."""


class _TrainParser(SentenceParser, LightningArgumentParser):
    """Lightning's parser with errors in one sentence."""

    help_command = "python -m train fit --help"
    renamed = _RENAMED


class SkinCLI(LightningCLI):
    """LightningCLI with one fixed run directory and no silent restarts."""

    def add_arguments_to_parser(self, parser: LightningArgumentParser) -> None:
        """Add the folder of the run."""
        parser.add_argument(
            "--run", type=str, default="runs/run", help="Folder of checkpoints, curves, pictures."
        )

    @staticmethod
    def subcommands() -> dict[str, set[str]]:
        """Return the available commands, each with the arguments that it does not take."""
        kept = ("fit", "validate", "test")
        return {name: LightningCLI.subcommands()[name] for name in kept}

    def _parse_ckpt_path(self) -> None:
        # Lightning would let the checkpoint's hyper-parameters override the configuration.
        check_checkpoint(self.config.subcommand, self.config[self.config.subcommand].ckpt_path)

    def before_instantiate_classes(self) -> None:
        """Load checkpoints as data."""
        # With weights_only no code in a checkpoint is run.
        self.config[self.subcommand].weights_only = True

    def instantiate_trainer(self, **kwargs: Any) -> Trainer:
        """Make a trainer with the loggers and callbacks of every run."""
        config = self.config[self.subcommand]
        run = config.run
        loggers = [TensorBoardLogger(run, name="", version=""), CurveLogger(run)]
        best = ModelCheckpoint(
            run,
            "best",
            monitor="val/loss",
            enable_version_counter=False,
            save_on_train_epoch_end=False,
        )
        callbacks = [best, FiniteGuard(run), LastCheckpoint(run)]
        callbacks += [PictureGrid(run), LearningRateMonitor()]
        callbacks += _as_list(self.config_init[self.subcommand].trainer.callbacks)
        if config.trainer.enable_progress_bar is not False:
            callbacks.append(_make_progress_bar())
        trainer = super().instantiate_trainer(
            logger=loggers, callbacks=callbacks, default_root_dir=run, **kwargs
        )
        # Only the first of several processes may rename; the trainer knows which one it is.
        if self.subcommand == "fit" and config.ckpt_path is None and trainer.is_global_zero:
            keep_previous(Path(run))
        return trainer


def _as_list(callbacks: Callback | list[Callback] | None) -> list[Callback]:
    if callbacks is None:
        return []
    return callbacks if isinstance(callbacks, list) else [callbacks]


def check_checkpoint(subcommand: str, path: str | None) -> None:
    """Check the checkpoint that a command needs.

    Raises:
        InputError: If it is missing, broken, or not of skinnet.
    """
    if path is None:
        if subcommand != "fit":
            raise InputError(f"{subcommand} needs a trained model: add --ckpt_path RUN/best.ckpt.")
    else:
        read_checkpoint(path)


RUN_FILES = ("*.ckpt", "metrics.csv", "events.out.tfevents.*", "skipped.csv")
"""Files that training writes into the folder of a run."""


def keep_previous(run: Path) -> None:
    """Rename the folder of an earlier run to the next free number, so that nothing is lost.

    Raises:
        InputError: For a folder whose files are not those of a run.
    """
    run = run.resolve()
    if not run.is_dir() or not any(run.iterdir()):
        return
    if not any(next(run.glob(name), None) for name in RUN_FILES):
        raise InputError(
            f"{run} holds files that are not those of a run; give another folder with --run."
        )
    number = next(n for n in range(1, 10**6) if not run.with_name(f"{run.name}.{n}").exists())
    kept = run.with_name(f"{run.name}.{number}")
    run.rename(kept)
    print(f"{run} holds an earlier run; it is kept as {kept}.", file=sys.stderr)


def _make_progress_bar() -> RichProgressBar | TQDMProgressBar:
    # Without a terminal, Rich shows only its last frame.
    return RichProgressBar() if sys.stderr.isatty() else TQDMProgressBar(refresh_rate=50)


_EXPECTED_WARNINGS = (
    "LightningCLI's args parameter is intended",  # tests pass a list
    r"(?s)\s*.*was deprecated in v4",  # Lightning uses it
    r"\s*By default only one JsonargparseDeprecationWarning",
    "The '.*_dataloader' does not have many workers",  # sampling scenes is a small part of a step
    r"`isinstance.treespec, LeafSpec.` is deprecated",
    "Precision bf16-mixed is not supported by the model summary",
    "Checkpoint directory .* exists and is not empty",  # the run folder, on purpose
    "The number of training batches .* is smaller than the logging interval",
)
"""Warnings of Lightning about intended settings."""


def _is_no_advertisement(record: logging.LogRecord) -> bool:
    return "litlogger" not in record.getMessage()


def main(arguments: Sequence[str] | None = None) -> int:
    """Run a training command; return 0, or 2 with a sentence on stderr for bad input."""
    logging.getLogger("lightning.pytorch.utilities.rank_zero").addFilter(_is_no_advertisement)
    try:
        with warnings.catch_warnings():
            for message in _EXPECTED_WARNINGS:
                warnings.filterwarnings("ignore", message)
            SkinCLI(
                SkinTask,
                LightningDataModule,
                subclass_mode_data=True,
                seed_everything_default=0,
                parser_class=_TrainParser,
                save_config_kwargs={"overwrite": True},
                args=list(arguments) if arguments is not None else None,
                parser_kwargs={"prog": "python -m train"},
            )
    except (InputError, MisconfigurationException, OSError) as error:
        print(f"train: {error}", file=sys.stderr)
        return 2
    return 0
