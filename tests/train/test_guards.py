"""Training stops with a sentence before it overwrites good weights."""

from collections.abc import Callable
from functools import partial
from pathlib import Path

import pytest
import torch
from torch import Tensor

from skinnet.network import SkinAutoencoder, read_checkpoint
from train.callbacks import LastCheckpoint
from train.guards import find_not_finite, list_names
from train.task import SkinTask, compute_losses

Fit = Callable[..., int]


@pytest.fixture
def saving_every_step(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("train.cli.LastCheckpoint", partial(LastCheckpoint, seconds=0.0))


def break_loss(monkeypatch: pytest.MonkeyPatch, term: str, call: int) -> None:
    """Makes a loss not a number the `call`-th time it is computed."""
    calls = iter(range(1, 1000))

    def broken(*arguments: object) -> dict[str, Tensor]:
        found = compute_losses(*arguments)  # type: ignore[arg-type]
        if next(calls) == call:
            found[term] = found[term] * float("nan")
        return found

    monkeypatch.setattr("train.task.compute_losses", broken)


@pytest.mark.usefixtures("saving_every_step")
def test_a_loss_that_is_no_number_stops_training_at_the_last_good_step(
    fit: Fit, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    run = tmp_path / "run"
    break_loss(monkeypatch, "lighting", 7)  # four steps, a validation batch, two steps
    assert fit(run, "--trainer.max_epochs=2") == 2
    message = capsys.readouterr().err
    assert "step 5, where losses are not finite: train/synthetic_lighting, train/loss." in message
    assert f"--ckpt-path {run / 'last.ckpt'}" in message
    assert read_checkpoint(run / "last.ckpt")["global_step"] == 5
    model = SkinAutoencoder.from_pretrained(run / "last.ckpt")
    assert not find_not_finite(model.state_dict())
    assert fit(run, f"--ckpt_path={run / 'last.ckpt'}", "--trainer.max_epochs=2") == 0


def test_without_a_checkpoint_the_remedy_is_a_new_run(
    fit: Fit, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    break_loss(monkeypatch, "pigment_l1", 1)
    assert fit(tmp_path / "run", "--trainer.max_epochs=1") == 2
    message = capsys.readouterr().err
    assert "step 0" in message and "train/synthetic_pigment_l1" in message
    assert "learning_rate" in message and "ckpt_path" not in message
    assert not (tmp_path / "run" / "last.ckpt").exists()


def test_a_broken_validation_is_not_called_the_best(
    fit: Fit, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    break_loss(monkeypatch, "mask", 5)
    assert fit(tmp_path / "run", "--trainer.max_epochs=2") == 2
    assert "not finite: val/loss" in capsys.readouterr().err
    assert not (tmp_path / "run" / "best.ckpt").exists()


@pytest.mark.usefixtures("saving_every_step")
def test_broken_weights_are_not_saved(
    fit: Fit, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    run, step = tmp_path / "run", SkinTask.optimizer_step

    def breaking(task: SkinTask, *arguments: object) -> None:
        step(task, *arguments)  # type: ignore[arg-type]
        if task.global_step == 2:  # counted after this
            next(task.parameters()).data.fill_(float("inf"))

    monkeypatch.setattr(SkinTask, "optimizer_step", breaking)
    assert fit(run, "--trainer.max_epochs=1") == 2
    assert "where weights are not finite: model." in capsys.readouterr().err
    assert read_checkpoint(run / "last.ckpt")["global_step"] == 2


def test_broken_weights_are_named_rather_than_all_the_losses_that_they_break(
    fit: Fit, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def breaking(task: SkinTask, *_: object) -> None:
        if task.global_step == 3:
            next(task.parameters()).data.fill_(float("nan"))

    monkeypatch.setattr(SkinTask, "on_train_batch_start", breaking)
    assert fit(tmp_path / "run", "--trainer.max_epochs=1") == 2
    assert "step 3, where weights are not finite: model." in capsys.readouterr().err


def test_names_are_listed_up_to_a_number() -> None:
    assert list_names(["a", "b"], 2) == "a, b"
    assert list_names(["a", "b", "c"], 2) == "a, b and 1 more"
    values = {
        "whole": torch.ones(2, dtype=torch.long),
        "good": torch.ones(2),
        "bad": torch.ones(2) / 0,
    }
    assert find_not_finite(values) == ["bad"] and find_not_finite({}) == []
