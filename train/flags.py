"""Refuses flags that Lightning would accept although they do nothing, or something else."""

import os
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from jsonargparse import Namespace
from lightning import Callback, Trainer
from lightning.fabric.plugins.environments.lightning import LightningEnvironment
from lightning.pytorch.callbacks import (
    GradientAccumulationScheduler,
    ModelCheckpoint,
    StochasticWeightAveraging,
)
from lightning.pytorch.strategies import ParallelStrategy

from skinnet.errors import InputError
from train.logs import CurveLogger, EventLogger
from train.run_folder import check_writable

PRECISIONS = ("32-true", "16-mixed", "bf16-mixed")
_SEEDS = 2**32

_ONE_BATCH = "leave it at 1 and give a larger batch_size, or more processes"
_FIXED = {
    "default_root_dir": (None, "the folder of a run is --run; leave this out"),
    "model_registry": (None, "checkpoints are files here; give one with --ckpt-path"),
    "enable_checkpointing": (
        (None, True),
        "a run always keeps last.ckpt and best.ckpt; leave this out, or try a few steps without "
        "writing anything with --trainer.fast_dev_run 10",
    ),
    "barebones": (
        False,
        "a run keeps its curves and checkpoints; leave this out, or try a few steps without "
        "writing anything with --trainer.fast_dev_run 10",
    ),
    "overfit_batches": (
        0,
        "every step has new pictures, so that no batch can be repeated; leave this out, or give "
        "fewer --data.init_args.train_samples",
    ),
    "accumulate_grad_batches": (1, _ONE_BATCH),
}
"""Flags of the trainer that have one value here, and what to do instead."""

_LEAST = {
    "num_sanity_val_steps": (-1, "-1 is all batches"),
    "log_every_n_steps": (0, "0 logs nothing"),
    "check_val_every_n_epoch": (1, "null counts the steps of all epochs"),
    "gradient_clip_val": (0, "0 does not clip"),
    "min_epochs": (0, "leave it out for none"),
    "min_steps": (0, "leave it out for none"),
}
"""Smallest value of a flag of the trainer, and what it or its absence means."""


def check_flags(command: str, given: Namespace) -> None:
    """Check the flags by themselves, before anything is made from them.

    Args:
        command: Fit, validate or test.
        given: Arguments of the command.

    Raises:
        InputError: For a value that would do nothing, or something else than it says.
    """
    seed = given.seed_everything
    if not isinstance(seed, bool) and not 0 <= seed < _SEEDS:
        raise InputError(
            f"--seed-everything is {seed}; give a whole number from 0 to {_SEEDS - 1}."
        )
    if given.weights_only is False:
        raise InputError(
            "--weights-only is false, and checkpoints are only read as data, so that no code in "
            "them is run; leave it out."
        )
    if not given.run:
        raise InputError("--run is empty; give the folder of the run.")
    for sentence in _find_idle(vars(given.trainer), command == "fit"):
        raise InputError(sentence)


def _find_idle(trainer: dict[str, Any], fitting: bool) -> Iterator[str]:
    """Sentences on the flags of the trainer."""
    for name, (value, remedy) in _FIXED.items():
        allowed = value if isinstance(value, tuple) else (value,)
        if trainer[name] not in allowed:
            yield f"--trainer.{name} is {_write(trainer[name])}; {remedy}."
    for name, (least, meaning) in _LEAST.items():
        value = trainer[name]
        if value is not None and not value >= least:
            yield f"--trainer.{name} is {value}; give at least {least} ({meaning})."
    if trainer["gradient_clip_algorithm"] and trainer["gradient_clip_val"] is None:
        yield (
            "--trainer.gradient_clip_algorithm does nothing alone; add --trainer.gradient_clip_val."
        )
    if trainer["profiler"] == "xla":
        yield "--trainer.profiler is xla, which is for TPUs; give simple, advanced or pytorch."
    if trainer["val_check_interval"] == 0:
        yield (
            "--trainer.val_check_interval is 0; give a number of steps or a share of an epoch, or "
            "turn validation off with --trainer.limit_val_batches 0."
        )
    if fitting:
        yield from _find_contradictions(trainer)


def _find_contradictions(trainer: dict[str, Any]) -> Iterator[str]:
    for name in ("limit_train_batches", "max_epochs", "max_steps"):
        if trainer[name] == 0:
            yield f"--trainer.{name} is 0, so that no step would be taken; give more."
    for unit in ("epochs", "steps"):
        least, most = trainer[f"min_{unit}"], trainer[f"max_{unit}"]
        if least and most and 0 < most < least:
            yield (
                f"--trainer.min_{unit} is {least}, more than --trainer.max_{unit} {most}; give "
                "fewer of the first or more of the second."
            )


def check_trainer(trainer: Trainer, run: str) -> None:
    """Check what has become of the flags in a trainer.

    Args:
        trainer: A new trainer.
        run: Folder of the run.

    Raises:
        InputError: For a setting that would fail later, or not do what it says.
    """
    for sentence in _find_unfit(trainer):
        raise InputError(sentence)
    for callback in _list_callbacks(trainer):
        if isinstance(callback, GradientAccumulationScheduler | StochasticWeightAveraging):
            raise InputError(
                f"{type(callback).__name__} changes --trainer.accumulate_grad_batches; leave this "
                "callback out."
            )
        if isinstance(callback, ModelCheckpoint) and callback.dirpath is not None:
            # Ours has the folder of the run, which is checked with more care.
            if not _lies_in(str(callback.dirpath), run):
                check_writable(Path(callback.dirpath), "another dirpath to ModelCheckpoint")
    for logger in trainer.loggers:
        if not isinstance(logger, CurveLogger | EventLogger) and _lies_in(logger.save_dir, run):
            raise InputError(
                f"{type(logger).__name__} would write into {run} before it is known whether a run "
                "starts there; give it a folder of its own (save_dir)."
            )


def _list_callbacks(trainer: Trainer) -> list[Callback]:
    return trainer.callbacks  # type: ignore[attr-defined, no-any-return]


def _lies_in(folder: str | None, run: str) -> bool:
    if folder is None:
        return False
    inner = Path(folder).resolve()
    return Path(run).resolve() in (inner, *inner.parents)


def _find_unfit(trainer: Trainer) -> Iterator[str]:
    if trainer.precision not in PRECISIONS:
        yield (
            f"--trainer.precision is {trainer.precision}, and the physics is computed in float32; "
            f"give one of {', '.join(PRECISIONS)}."
        )
    on_cpu = trainer.strategy.root_device.type == "cpu"
    # Two are always allowed, so that several processes can be tried on any machine.
    most = max(os.cpu_count() or 1, 2)
    if on_cpu and trainer.num_devices > most:
        yield (
            f"--trainer.devices is {trainer.num_devices} on a CPU, where each is a process; there "
            f"are {most} processors. Give at most as many."
        )
    if on_cpu and trainer.world_size > 1 and _syncs_batchnorm(trainer):
        yield "--trainer.sync_batchnorm works on GPUs only; leave it out on a CPU."
    if trainer.num_nodes > 1 and _is_alone(trainer):
        yield (
            f"--trainer.num_nodes is {trainer.num_nodes} and MASTER_ADDR is not set, so that this "
            "machine would wait for the others; set MASTER_ADDR, MASTER_PORT and NODE_RANK on "
            "each machine."
        )


def _syncs_batchnorm(trainer: Trainer) -> bool:
    strategy = trainer.strategy
    return isinstance(strategy, ParallelStrategy) and strategy._layer_sync is not None


def _is_alone(trainer: Trainer) -> bool:
    """Whether nothing says where the other machines are."""
    strategy = trainer.strategy
    return (
        isinstance(strategy, ParallelStrategy)
        and isinstance(strategy.cluster_environment, LightningEnvironment)
        and "MASTER_ADDR" not in os.environ
    )


def describe_no_step(trainer: Trainer, checkpoint: str | None) -> str:
    """Write why a training has taken no step.

    Args:
        trainer: Trainer after the training.
        checkpoint: Checkpoint from which the training went on.
    """
    if checkpoint is not None:
        return (
            f"No step was taken: {checkpoint} is at step {trainer.global_step}, where this "
            "training ends; give more --trainer.max_epochs or --trainer.max_steps."
        )
    return "No step was taken; give more --trainer.max_time, or leave it out."


def _write(value: Any) -> str:
    return str(value).lower() if isinstance(value, bool) else str(value)
