"""Writes loss curves: to one growing CSV file, and as events of TensorBoard."""

import csv
from collections.abc import Callable
from pathlib import Path
from typing import Any

from lightning.pytorch.loggers import Logger, TensorBoardLogger
from lightning.pytorch.loggers.logger import DummyLogger
from lightning.pytorch.utilities import rank_zero_only


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
        new = not self.path.exists()
        self.path.parent.mkdir(parents=True, exist_ok=True)
        with self.path.open("a", newline="") as file:
            writer = csv.writer(file, lineterminator="\n")
            if new:
                writer.writerow(("step", "metric", "value"))
            writer.writerows(self.held)
        self.held = []


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
