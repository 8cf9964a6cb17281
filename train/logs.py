"""Writes loss curves: to one growing CSV file, and as events of TensorBoard."""

import csv
import io
import os
import threading
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from lightning.pytorch.loggers import Logger, TensorBoardLogger
from lightning.pytorch.loggers.logger import DummyLogger
from lightning.pytorch.utilities import rank_zero_only

_LINE = 4096
"""Bytes within which a line of a curve ends."""


class CurveLogger(Logger):
    """Appends a line `step,metric,value` to `metrics.csv` for every number logged.

    Lightning's own CSVLogger deletes the file when a run is resumed. Nothing is written before
    `start`.

    Args:
        folder: Folder of the run.
    """

    def __init__(self, folder: str) -> None:
        super().__init__()
        self.path = Path(folder) / "metrics.csv"
        self.started = False
        self.held: list[tuple[int | None, str, str]] = []

    @property
    def name(self) -> str:
        """Return the name that Lightning requires."""
        return "curves"

    @property
    def version(self) -> str:
        """Return no version; a run has a folder of its own."""
        return ""

    def log_hyperparams(self, *args: Any, **kwargs: Any) -> None:
        """Log nothing; the configuration is saved as config.yaml."""

    @rank_zero_only
    def log_metrics(self, metrics: dict[str, float], step: int | None = None) -> None:
        """Append each metric of this step."""
        self.held += [(step, name, f"{value:.6g}") for name, value in metrics.items()]
        if self.started:
            self._write()

    @rank_zero_only
    def start(self) -> None:
        """Write what was logged so far; from now on everything is written at once."""
        self.started = True
        self._write()

    def _write(self) -> None:
        self.path.parent.mkdir(parents=True, exist_ok=True)
        with self.path.open("a+b", 0) as file:
            size = _end_of_lines(file)
            file.truncate(size)  # a full disk leaves a part of a line
            rows = self.held if size else [("step", "metric", "value"), *self.held]
            try:
                data = memoryview(_format(rows))
                while data:
                    data = data[file.write(data) :]
            except OSError as error:
                file.truncate(size)
                error.filename = str(self.path)
                raise
        self.held = []


def _end_of_lines(file: io.FileIO) -> int:
    """Where the last whole line of a file ends."""
    size = file.seek(0, os.SEEK_END)
    file.seek(max(size - _LINE, 0))
    end = file.read().rfind(b"\n")
    return max(size - _LINE, 0) + end + 1


def _format(rows: Iterable[Sequence[object]]) -> bytes:
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerows(rows)
    return text.getvalue().encode()


@contextmanager
def hush_writers() -> Iterator[None]:
    """Keep from standard error what threads print of a disk that cannot be written.

    TensorBoard writes in a thread, and raises its error in the main one too.
    """
    usual = threading.excepthook
    threading.excepthook = lambda args: None if isinstance(args.exc_value, OSError) else usual(args)
    try:
        yield
    finally:
        threading.excepthook = usual


class EventLogger(TensorBoardLogger):
    """Events of TensorBoard in the folder of the run, which are written from `start` on.

    Args:
        folder: Folder of the run.
    """

    def __init__(self, folder: str) -> None:
        super().__init__(folder, name="", version="")
        self.started = False
        self.held: list[tuple[Callable[..., None], dict[str, Any]]] = []

    @property
    def experiment(self) -> Any:
        """Return TensorBoard's writer; before `start`, one that does nothing."""
        return super().experiment if self.started else DummyLogger().experiment

    @rank_zero_only
    def log_metrics(self, metrics: Any, step: int | None = None) -> None:
        """Log each metric of this step."""
        if self.started:
            super().log_metrics(metrics, step)
        else:
            self.held.append((self.log_metrics, {"metrics": metrics, "step": step}))

    @rank_zero_only
    def log_hyperparams(self, params: Any, metrics: Any = None, step: int | None = None) -> None:
        """Log the hyperparameters."""
        if self.started:
            super().log_hyperparams(params, metrics, step)
        else:
            arguments = {"params": params, "metrics": metrics, "step": step}
            self.held.append((self.log_hyperparams, arguments))

    @rank_zero_only
    def save(self) -> None:
        """Write what is not yet on the disk."""
        if self.started:
            super().save()

    @rank_zero_only
    def start(self) -> None:
        """Open the file, and write what was logged so far."""
        self.started = True
        for log, arguments in self.held:
            log(**arguments)
        self.held = []
        self.save()
