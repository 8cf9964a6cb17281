"""Several processes train as one does."""

import csv
import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

Fit = Callable[..., int]
Arguments = Callable[..., list[str]]

TWO = (
    "--trainer.strategy=ddp",
    "--trainer.devices=2",
    "--data.init_args.batch_size=2",
    "--trainer.max_epochs=2",
    "--trainer.callbacks+=two_processes.Witness",
)


def train_twice(arguments: list[str]) -> subprocess.CompletedProcess[str]:
    """Runs the command as users do; Lightning starts the second process by running it again."""
    here = {"PYTHONPATH": str(Path(__file__).parent)}
    command = [sys.executable, "-m", "train", *arguments]
    return subprocess.run(
        command, env={**os.environ, **here}, capture_output=True, text=True, timeout=300
    )


def read_curves(run: Path) -> list[tuple[str, str, float]]:
    """Every training loss and validation metric of a run, with its step and name."""
    kept = ("train/", "val/synthetic_")
    with (run / "metrics.csv").open() as file:
        rows = [row for row in csv.DictReader(file) if row["metric"].startswith(kept)]
    return [(row["step"], row["metric"], float(row["value"])) for row in rows]


@pytest.mark.slow
def test_two_processes_have_the_samples_losses_and_metrics_of_one(
    fit: Fit, fit_arguments: Arguments, tmp_path: Path
) -> None:
    one, two, notes = (tmp_path / name for name in ("one", "two", "notes"))
    for folder in (notes, two):
        folder.mkdir()
    (two / "metrics.csv").touch()
    witness = f"--trainer.callbacks.init_args.folder={notes}"
    done = train_twice(fit_arguments(two, *TWO, witness))
    assert done.returncode == 0, done.stderr
    assert fit(one, "--trainer.max_epochs=2") == 0

    drawn = [[int(n) for n in (notes / f"{rank}.txt").read_text().split()] for rank in range(2)]
    for epoch in range(2):
        part = slice(8 * epoch, 8 * epoch + 8)
        seen = [*drawn[0][part], *drawn[1][part]]
        assert sorted(seen) == list(range(16 * epoch, 16 * epoch + 16))
    curves = [sorted(read_curves(run)) for run in (two, one)]
    assert any(name == "val/synthetic_melanin_r" for _, name, _ in curves[0])
    for ours, theirs in zip(*curves, strict=True):
        # Evaluation uses running statistics of the batches, whose rounding errors accumulate.
        rel, least = (1e-5, 1e-6) if ours[1].startswith("train/") else (5e-3, 1e-3)
        assert ours[:2] == theirs[:2] and ours[2] == pytest.approx(theirs[2], rel=rel, abs=least)

    assert {"last.ckpt", "best.ckpt", "config.yaml"} <= {path.name for path in two.iterdir()}
    assert sorted(path.name for path in tmp_path.glob("two*")) == ["two", "two.1"]


@pytest.mark.slow
def test_both_processes_stop_in_words_when_one_has_a_broken_loss(
    fit_arguments: Arguments, tmp_path: Path
) -> None:
    run = tmp_path / "run"
    witness = [
        f"--trainer.callbacks.init_args.{each}" for each in (f"folder={tmp_path}", "break_at=5")
    ]
    done = train_twice(fit_arguments(run, *TWO, *witness))
    assert done.returncode == 2, done.stderr
    assert "step 5, where losses are not finite" in done.stderr
    assert "Traceback" not in done.stderr
    assert (run / "last.ckpt").is_file()
