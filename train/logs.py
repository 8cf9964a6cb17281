"""Writes loss curves to one growing CSV file."""

import csv
from pathlib import Path
from typing import Any

from lightning.pytorch.loggers import Logger
from lightning.pytorch.utilities import rank_zero_only


class CurveLogger(Logger):
    """Appends a line `step,metric,value` to `metrics.csv` for every number logged.

    Lightning's own CSVLogger deletes the file when a run is resumed.

    Args:
        folder: Folder of the run.
    """

    def __init__(self, folder: str) -> None:
        super().__init__()
        self.path = Path(folder) / "metrics.csv"

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
        new = not self.path.exists()
        self.path.parent.mkdir(parents=True, exist_ok=True)
        with self.path.open("a", newline="") as file:
            writer = csv.writer(file, lineterminator="\n")
            if new:
                writer.writerow(("step", "metric", "value"))
            for name, value in metrics.items():
                writer.writerow((step, name, f"{value:.6g}"))
