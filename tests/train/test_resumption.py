"""A checkpoint from which training cannot go on is refused in one sentence."""

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
import torch
from small_runs import list_arguments

Fit = Callable[..., int]


@pytest.fixture(scope="module")
def last(tmp_path_factory: pytest.TempPathFactory, casts: Path) -> Path:
    from train.cli import main

    run = tmp_path_factory.mktemp("resumption") / "run"
    assert main(list_arguments(run, casts, "--trainer.max_steps=1")) == 0
    return run / "last.ckpt"


def _strip(checkpoint: dict[str, Any]) -> None:
    for name in [key for key in checkpoint if key not in ("skinnet", "state_dict")]:
        del checkpoint[name]


def _drop_optimizer(checkpoint: dict[str, Any]) -> None:
    checkpoint["optimizer_states"] = []


def _shrink_optimizer(checkpoint: dict[str, Any]) -> None:
    checkpoint["optimizer_states"][0]["state"][0]["exp_avg"] = torch.zeros(1)


def _change_shape(checkpoint: dict[str, Any]) -> None:
    name = next(iter(checkpoint["state_dict"]))
    checkpoint["state_dict"][name] = torch.zeros(7)


def _lose_weight(checkpoint: dict[str, Any]) -> None:
    checkpoint["state_dict"].popitem()


def _break_weight(checkpoint: dict[str, Any]) -> None:
    name = next(iter(checkpoint["state_dict"]))
    checkpoint["state_dict"][name].fill_(float("nan"))


CHANGES = {
    "a mean of checkpoints": (_strip, "without the state of its training"),
    "no state of the optimizer": (_drop_optimizer, "the state of its optimizer is damaged"),
    "another shape of the optimizer": (_shrink_optimizer, "the optimizer's state"),
    "other shapes": (_change_shape, r"is \[7\], and"),
    "a missing weight": (_lose_weight, "lacks"),
    "no number": (_break_weight, "no weights of a trained model: nan"),
}


@pytest.mark.slow
@pytest.mark.parametrize("kind", CHANGES)
def test_unsuitable_checkpoints(
    kind: str, last: Path, fit: Fit, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    change, expected = CHANGES[kind]
    checkpoint = torch.load(last, weights_only=True)
    change(checkpoint)
    torch.save(checkpoint, tmp_path / "changed.ckpt")
    capsys.readouterr()
    path = f"--ckpt_path={tmp_path / 'changed.ckpt'}"
    assert fit(tmp_path / "run", path, "--trainer.max_steps=2") == 2
    said = capsys.readouterr().err
    assert "changed.ckpt" in said and len(said.splitlines()) == 1
    assert re.search(expected, said)
    assert not (tmp_path / "run").exists()


@pytest.mark.slow
def test_other_widths(
    last: Path, fit: Fit, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path, widths = f"--ckpt_path={last}", "--model.widths=[4,6]"
    assert fit(tmp_path / "run", path, widths, "--trainer.max_steps=2") == 2
    said = capsys.readouterr().err
    assert "give --model.widths=[4,8]" in said and len(said.splitlines()) == 1
