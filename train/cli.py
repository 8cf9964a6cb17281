"""`python -m train fit | validate | test --config configs/NAME.yaml`."""

import logging
import sys
import warnings
from collections.abc import Sequence
from typing import Any

import torch
from jsonargparse import Namespace
from lightning import Callback, LightningDataModule, Trainer
from lightning.pytorch.callbacks import (
    LearningRateMonitor,
    ProgressBar,
    RichProgressBar,
    TQDMProgressBar,
)
from lightning.pytorch.cli import LightningArgumentParser, LightningCLI
from lightning.pytorch.loggers import Logger

from skinnet.errors import InputError
from skinnet.inference._command.assumptions import describe_versions
from skinnet.inference._command.spelling import spell_keys
from skinnet.inference._command.verb_parser import take_verbosity
from skinnet.inference._messages import Verbosity, note, note_removed, report
from skinnet.network import read_checkpoint
from skinnet.pipeline._sentence_parser import SentenceParser
from train.callbacks import (
    LastCheckpoint,
    PictureGrid,
    WholeCheckpoints,
    make_best_checkpoint,
    report_best,
)
from train.fitted import FittedFaces
from train.flags import check_flags, check_trainer, describe_no_step
from train.guards import FiniteGuard
from train.logs import CurveLogger, EventLogger, hush_writers
from train.monitors import check_monitors, list_logged
from train.pairs import PortraitPairs
from train.portraits import Portraits
from train.refusals import explain_refusals, find_guilty, list_given, write_refusal
from train.resumption import check_resumption
from train.run_folder import RunFolder, check_run_folder
from train.synthetic.faces import SyntheticFaces
from train.task import SkinTask

__all__ = ["FittedFaces", "PortraitPairs", "Portraits", "SkinCLI", "SyntheticFaces", "main"]

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

    @property
    def given(self) -> Namespace:
        """Return the arguments of the command."""
        given: Namespace = self.config[self.config.subcommand]
        return given

    @property
    def writes(self) -> bool:
        """Return whether the command makes a run; evaluations and trials write nothing."""
        return self.config.subcommand == "fit" and not self.given.trainer.fast_dev_run

    def _parse_ckpt_path(self) -> None:
        # Lightning would let the checkpoint's hyper-parameters override the configuration.
        check_flags(self.config.subcommand, self.given)
        check_checkpoint(self.config.subcommand, self.given.ckpt_path)
        if self.writes:
            check_run_folder(self.given.run, self.given.ckpt_path)

    def before_instantiate_classes(self) -> None:
        """Load checkpoints as data."""
        # With weights_only no code in a checkpoint is run.
        self.given.weights_only = True

    def instantiate_classes(self) -> None:
        """Make the data, the model and the trainer."""
        with explain_refusals(self._explain):
            super().instantiate_classes()

    def instantiate_trainer(self, **kwargs: Any) -> Trainer:
        """Make a trainer with the loggers and callbacks of every run."""
        wanted = self.config_init[self.subcommand].trainer
        callbacks, loggers = self._make_own(wanted.logger is not False)
        callbacks += _as_list(wanted.callbacks)
        if wanted.enable_progress_bar is not False and not _has_progress_bar(callbacks):
            callbacks.append(_make_progress_bar())
        settings = {
            **vars(wanted),
            "logger": loggers + _as_list(wanted.logger),
            "callbacks": callbacks,
            "default_root_dir": self.given.run,
            "plugins": [*_as_list(wanted.plugins), WholeCheckpoints()],
            **kwargs,
        }
        with explain_refusals(lambda error: self._explain(error, settings)):
            trainer = super().instantiate_trainer(**settings)
        check_trainer(trainer, self.given.run)
        if self.writes:
            logged = list_logged(self.datamodule)
            check_monitors(trainer, self.config_init[self.subcommand].lr_scheduler, logged)
        return trainer

    def _make_own(self, with_loggers: bool) -> tuple[list[Callback], list[Logger]]:
        """The callbacks and loggers of every run."""
        run = self.given.run
        # Lightning misses it in evaluation too, since checkpoints have its state.
        best = make_best_checkpoint(run)
        if self.subcommand != "fit":
            return [best], []
        config = self._parser("fit").dump(self.given, skip_none=False)
        folder = RunFolder(run, config, self.given.ckpt_path, dry=not self.writes)
        callbacks: list[Callback] = [folder, best, FiniteGuard(folder.find_last)]
        loggers: list[Logger] = []
        if with_loggers:
            callbacks.append(LearningRateMonitor())
            loggers = [EventLogger(run), CurveLogger(run)]
        if self.writes:
            callbacks += [LastCheckpoint(run), PictureGrid(run)]
        return callbacks, loggers

    def _explain(self, error: Exception, settings: dict[str, Any] | None = None) -> str:
        given = list_given(self.given)
        return write_refusal(error, given, find_guilty(given, settings) if settings else [])

    def _check_checkpoint(self, training: bool) -> None:
        if self.given.ckpt_path is not None:
            check_resumption(self.given.ckpt_path, self.model, training)

    def fit(self, **kwargs: Any) -> None:
        """Train.

        Raises:
            InputError: If Lightning refuses the flags, or if no step is taken.
        """
        self._check_checkpoint(training=True)
        with explain_refusals(self._explain):
            self.trainer.fit(**kwargs)
        # Processes that were spawned give nothing back but their metrics.
        if not self.trainer.callback_metrics:
            raise InputError(describe_no_step(self.trainer, self.given.ckpt_path))
        if self.writes:
            report_best(self.trainer)

    def validate(self, **kwargs: Any) -> None:
        """Evaluate a checkpoint on the validation data."""
        self._check_checkpoint(training=False)
        with explain_refusals(self._explain):
            self.trainer.validate(**kwargs)

    def test(self, **kwargs: Any) -> None:
        """Evaluate a checkpoint on the test data."""
        self._check_checkpoint(training=False)
        with explain_refusals(self._explain):
            self.trainer.test(**kwargs)


def _as_list(values: Any) -> list[Any]:
    if values is None or isinstance(values, bool):
        return []
    return list(values) if isinstance(values, list | tuple) else [values]


def check_checkpoint(subcommand: str, path: str | None) -> None:
    """Check the checkpoint that a command needs.

    Raises:
        InputError: If it is missing, broken, or not of skinnet.
    """
    if path is None:
        if subcommand != "fit":
            raise InputError(f"{subcommand} needs a trained model: add --ckpt-path RUN/best.ckpt.")
    else:
        read_checkpoint(path)


def _has_progress_bar(callbacks: list[Callback]) -> bool:
    return any(isinstance(each, ProgressBar) for each in callbacks)


def _make_progress_bar() -> RichProgressBar | TQDMProgressBar:
    # Without a terminal, Rich shows only its last frame.
    return RichProgressBar() if sys.stderr.isatty() else TQDMProgressBar(refresh_rate=50)


_PACKAGES = ("numpy", "torch", "lightning", "kornia", "jsonargparse")

_EXPECTED_WARNINGS = (
    "LightningCLI's args parameter is intended",  # tests pass a list
    r"(?s)\s*.*was deprecated in v4",  # Lightning uses it
    r"\s*By default only one JsonargparseDeprecationWarning",
    "The '.*_dataloader' does not have many workers",  # sampling scenes is a small part of a step
    r"`isinstance.treespec, LeafSpec.` is deprecated",
    "Precision bf16-mixed is not supported by the model summary",
    "Checkpoint directory .* exists and is not empty",  # the run folder, on purpose
    "The dirpath has changed from",  # the run was renamed, or goes on in another folder
    "The number of training batches .* is smaller than the logging interval",
)
"""Warnings of Lightning about intended settings."""


def _is_no_advertisement(record: logging.LogRecord) -> bool:
    return "litlogger" not in record.getMessage()


def main(arguments: Sequence[str] | None = None) -> int:
    """Run a training command; return 0, or 2 with a sentence on stderr for bad input."""
    logging.getLogger("lightning.pytorch.utilities.rank_zero").addFilter(_is_no_advertisement)
    given = [
        "--help" if word == "--help-all" else word
        for word in spell_keys(sys.argv[1:] if arguments is None else arguments)
    ]
    try:
        level, given = take_verbosity(given)
        given += _apply_verbosity(level)
        refusals = explain_refusals(lambda error: write_refusal(error, {}, []))
        with warnings.catch_warnings(), hush_writers(), refusals:
            for message in _EXPECTED_WARNINGS:
                warnings.filterwarnings("ignore", message)
            SkinCLI(
                SkinTask,
                LightningDataModule,
                subclass_mode_data=True,
                seed_everything_default=0,
                parser_class=_TrainParser,
                save_config_callback=None,  # the folder of the run has it
                args=given,
                parser_kwargs={"prog": "python -m train"},
            )
    except torch.OutOfMemoryError as error:
        note(describe_full_memory(error), "train")
        return 2
    except (InputError, OSError) as error:
        report(error, "train")
        return 2
    finally:
        note_removed()
    return 0


def _apply_verbosity(level: Verbosity) -> list[str]:
    """Set how much is said, and return the flags that it needs."""
    if level is Verbosity.QUIET:
        logging.getLogger("lightning.pytorch").setLevel(logging.ERROR)
        return ["--trainer.enable_progress_bar=false", "--trainer.enable_model_summary=false"]
    if level is Verbosity.VERBOSE:
        print(f"train: {describe_versions(_PACKAGES)}", file=sys.stderr)
    return []


def describe_full_memory(error: Exception) -> str:
    """Write what to do when a batch does not fit into memory."""
    text = str(error).partition(". ")[0]
    return f"{text}. Give a smaller --data.init_args.batch_size, or --trainer.precision bf16-mixed."
