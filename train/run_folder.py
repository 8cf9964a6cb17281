"""The folder of a run: made with its first step, so that a failed start leaves an earlier run."""

import sys
import tempfile
from pathlib import Path
from typing import Any

from lightning import Callback, LightningModule, Trainer

from skinnet.errors import InputError, _explain_fault
from skinnet.files import write_text
from skinnet.files._partial import sweep
from train.logs import CurveLogger, EventLogger
from train.portraits import Portraits, write_skipped

RUN_FILES = ("*.ckpt", "metrics.csv", "events.out.tfevents.*", "skipped.csv")
"""Files that training writes into the folder of a run."""


class RunFolder(Callback):
    """Makes the folder of a run when the first step has been taken.

    Until then nothing is written, and an earlier run stays where it is. All processes wait until
    the first of them has made the folder.

    Args:
        folder: Folder of the run.
        config: The configuration in YAML, which is kept in it.
        checkpoint: Checkpoint from which training goes on. If it lies in the folder, so does the
            run; every other run is renamed.
        dry: Whether steps are only tried, so that nothing is ever written.
    """

    def __init__(
        self, folder: str, config: str, checkpoint: str | None = None, dry: bool = False
    ) -> None:
        self.folder, self.config, self.dry = Path(folder), config, dry
        self.continued = continues_run(folder, checkpoint)
        self.started = False

    def find_last(self) -> Path | None:
        """Find the last checkpoint of this run; None if there is none yet."""
        path = self.folder / "last.ckpt"
        ours = (self.started or self.continued) and not self.dry
        return path if ours and path.is_file() else None

    def on_train_batch_end(
        self, trainer: Trainer, pl_module: LightningModule, *_: Any, **__: Any
    ) -> None:
        """Make the folder after the first step."""
        if self.started:
            return
        self.started = True
        if self.dry:
            return
        # Were the error raised in one process alone, the others would wait for it.
        refusal = trainer.strategy.broadcast(self._make(trainer) if trainer.is_global_zero else "")
        if refusal:
            raise InputError(refusal)
        for logger in trainer.loggers:
            if isinstance(logger, CurveLogger | EventLogger):
                logger.start()

    def _make(self, trainer: Trainer) -> str:
        """Make the folder, and return why that is not possible."""
        try:
            if not self.continued:
                keep_previous(self.folder)
            self.folder.mkdir(parents=True, exist_ok=True)
            write_text(self.folder / "config.yaml", self.config)
            # The method of Lightning's data modules has no hook for the first step.
            data: Any = getattr(trainer, "datamodule", None)
            if isinstance(data, Portraits):
                write_skipped(data.skipped, self.folder / "skipped.csv")
        except (InputError, OSError) as error:
            return str(error)
        return ""


def continues_run(folder: str, checkpoint: str | None) -> bool:
    """Tell whether a checkpoint lies in the folder of the run, so that this run goes on."""
    run = Path(folder).resolve()
    return checkpoint is not None and run in Path(checkpoint).resolve().parents


def check_run_folder(folder: str, checkpoint: str | None) -> None:
    """Check that a run can be written into a folder, without changing anything.

    Args:
        folder: Folder of the run.
        checkpoint: Checkpoint from which training goes on.

    Raises:
        InputError: If it is a file, holds files that are not those of a run, would have to be
            renamed while it is the current folder, or cannot be written.
    """
    run = Path(folder)
    if run.exists() and not run.is_dir():
        raise InputError(f"{run} is not a folder; give another one with --run.")
    sweep(run)
    if continues_run(folder, checkpoint):
        check_writable(run, "another folder with --run")
    else:
        _check_previous(run)
        check_writable(run.resolve().parent, "another folder with --run")


def keep_previous(run: Path) -> None:
    """Rename the folder of an earlier run to the next free number, so that nothing is lost.

    Raises:
        InputError: For a folder whose files are not those of a run.
    """
    run = run.resolve()
    if not _check_previous(run):
        return
    number = next(n for n in range(1, 10**6) if not run.with_name(f"{run.name}.{n}").exists())
    kept = run.with_name(f"{run.name}.{number}")
    run.rename(kept)
    print(f"{run} holds an earlier run; it is kept as {kept}.", file=sys.stderr)


def _check_previous(run: Path) -> bool:
    """Whether a folder holds an earlier run, which can be renamed."""
    run = run.resolve()
    if not run.is_dir() or not any(run.iterdir()):
        return False
    if not _was_killed_at_once(run) and not any(next(run.glob(name), None) for name in RUN_FILES):
        raise InputError(
            f"{run} holds files that are not those of a run; give another folder with --run."
        )
    if run in (here := Path.cwd().resolve(), *here.parents):
        raise InputError(
            f"{run} holds an earlier run and is the current folder, so that it cannot be renamed; "
            "start from another folder or give another one with --run."
        )
    return True


def _was_killed_at_once(run: Path) -> bool:
    """Whether a folder holds nothing but the settings of a run, and files that were in writing."""
    names = {entry.name for entry in run.iterdir() if not entry.name.startswith(".skinnet-")}
    if names != {"config.yaml"}:
        return not names
    with (run / "config.yaml").open(encoding="utf-8", errors="replace") as file:
        return file.readline().startswith("# lightning.pytorch==")


def check_writable(folder: Path, remedy: str) -> None:
    """Check that files can be written into a folder, which need not be there yet.

    Args:
        folder: The folder.
        remedy: What to give instead.

    Raises:
        InputError: If they cannot.
    """
    while not folder.exists():
        folder = folder.parent
    try:
        with tempfile.TemporaryDirectory(dir=folder, prefix=".skinnet"):
            pass
    except OSError as error:
        raise InputError(
            f"{folder} cannot be written {_explain_fault(error, f'give {remedy}')}."
        ) from error
