"""Small runs of the training command."""

from collections.abc import Callable
from pathlib import Path

import pytest

from train.cli import main

Fit = Callable[..., int]

SMALL = (
    "--model.widths=[4,8]",
    "--data.init_args.size=16",
    "--data.init_args.batch_size=4",
    "--data.init_args.train_samples=16",
    "--data.init_args.val_samples=4",
    "--trainer.precision=32-true",
    "--trainer.accelerator=cpu",
    "--trainer.enable_progress_bar=false",
    "--trainer.enable_model_summary=false",
    "--trainer.log_every_n_steps=1",
    "--model.warmup_steps=2",
)


@pytest.fixture
def fit() -> Fit:
    """Runs `python -m train fit` on `configs/quick.yaml`, made small, in a folder."""

    def run(folder: Path, *arguments: str) -> int:
        return main(["fit", "--config=configs/quick.yaml", f"--run={folder}", *SMALL, *arguments])

    return run
