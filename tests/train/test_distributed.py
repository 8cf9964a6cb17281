"""Several processes train as one does."""

import csv
import json
import os
import subprocess
import sys
from collections.abc import Callable
from importlib import import_module
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


def losses(run: Path) -> list[tuple[str, str, float]]:
    """Every training loss of a run with its step and name."""
    with (run / "metrics.csv").open() as file:
        rows = [row for row in csv.DictReader(file) if row["metric"].startswith("train/")]
    return [(row["step"], row["metric"], float(row["value"])) for row in rows]


@pytest.mark.slow
def test_two_processes_have_the_samples_and_losses_of_one(
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

    samples = [[int(n) for n in (notes / f"{rank}.txt").read_text().split()] for rank in range(2)]
    for epoch in range(2):
        part = slice(8 * epoch, 8 * epoch + 8)
        seen = [*samples[0][part], *samples[1][part]]
        assert sorted(seen) == list(range(16 * epoch, 16 * epoch + 16))
    for ours, theirs in zip(losses(two), losses(one), strict=True):
        assert ours[:2] == theirs[:2] and ours[2] == pytest.approx(theirs[2], rel=1e-5, abs=1e-6)

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


@pytest.mark.slow
def test_metrics_of_two_processes_are_those_of_all_pictures(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.syspath_prepend(Path(__file__).parent)
    whole = import_module("two_processes").measure((0, 1))
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([".", str(Path(__file__).parent)])}
    command = [sys.executable, "-m", "two_processes", str(tmp_path / "meeting")]
    started = [
        subprocess.Popen([*command, str(rank)], env=environment, stdout=subprocess.PIPE, text=True)
        for rank in range(2)
    ]
    found = [json.loads(process.communicate(timeout=300)[0]) for process in started]
    for each in found:
        assert each == pytest.approx(whole, rel=1e-5)
