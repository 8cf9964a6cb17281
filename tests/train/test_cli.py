"""The training command: what it leaves, how it goes on, what it refuses."""

import csv
from collections.abc import Callable
from functools import partial
from pathlib import Path

import pytest
import torch
import yaml
from lightning import Trainer

from skinnet.network import AutoencoderConfig, SkinAutoencoder
from train.callbacks import LastCheckpoint, PictureGrid
from train.cli import main

pytestmark = pytest.mark.slow

Fit = Callable[..., int]


def losses(run: Path) -> dict[int, float]:
    with (run / "metrics.csv").open() as file:
        rows = [row for row in csv.DictReader(file) if row["metric"] == "train/loss"]
    return {int(row["step"]): float(row["value"]) for row in rows}


def weights(path: Path) -> dict[str, torch.Tensor]:
    state: dict[str, torch.Tensor] = torch.load(path, weights_only=True)["state_dict"]
    return state


def test_a_run_leaves_checkpoints_configuration_curves_and_pictures(
    fit: Fit, tmp_path: Path
) -> None:
    run = tmp_path / "run"
    assert fit(run, "--trainer.max_epochs=1") == 0
    names = {path.name for path in run.iterdir()}
    assert {"last.ckpt", "best.ckpt", "config.yaml", "metrics.csv", "pictures"} <= names
    assert any(name.startswith("events.out.tfevents") for name in names)
    assert list((run / "pictures").glob("step_*.png"))
    assert yaml.safe_load((run / "config.yaml").read_text())["model"]["widths"] == [4, 8]


class Killed(BaseException):
    """Stands for the end of a process."""


@pytest.mark.parametrize("stopped_after", ["--trainer.max_epochs=2", "--trainer.max_steps=6"])
def test_a_resumed_run_has_the_losses_and_weights_of_one_that_never_stopped(
    fit: Fit, tmp_path: Path, stopped_after: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    # The learning rate follows the number of steps planned, which a shorter run would change.
    monkeypatch.setattr("train.task.warm_up_and_anneal", lambda step, warmup, steps: 1.0)
    whole, parts = tmp_path / "whole", tmp_path / "parts"
    assert fit(whole, "--trainer.max_epochs=3") == 0
    assert fit(parts, stopped_after) == 0
    resumed = (f"--ckpt_path={parts / 'last.ckpt'}", "--trainer.max_epochs=3")
    assert fit(parts, *resumed) == 0
    assert losses(parts) == losses(whole)
    one, other = weights(whole / "last.ckpt"), weights(parts / "last.ckpt")
    assert all(torch.equal(one[name], other[name]) for name in one)


def test_a_killed_run_goes_on_from_its_last_checkpoint(
    fit: Fit, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    whole, parts = tmp_path / "whole", tmp_path / "parts"
    assert fit(whole, "--trainer.max_epochs=2") == 0

    def kill(trainer: Trainer, *_: object) -> None:
        if trainer.global_step == 6:
            raise Killed

    monkeypatch.setattr("train.cli.LastCheckpoint", partial(LastCheckpoint, seconds=0.0))
    with monkeypatch.context() as context:
        context.setattr(PictureGrid, "on_train_batch_end", lambda _, *hook: kill(*hook))
        with pytest.raises(Killed):
            fit(parts, "--trainer.max_epochs=2")
    assert fit(parts, f"--ckpt_path={parts / 'last.ckpt'}", "--trainer.max_epochs=2") == 0
    one, other = weights(whole / "last.ckpt"), weights(parts / "last.ckpt")
    assert all(torch.equal(one[name], other[name]) for name in one)


def test_an_earlier_run_is_kept_aside(fit: Fit, tmp_path: Path) -> None:
    run = tmp_path / "run"
    run.mkdir()
    (run / "last.ckpt").write_bytes(b"precious")
    assert fit(run, "--trainer.max_steps=1") == 0
    assert (tmp_path / "run.1" / "last.ckpt").read_bytes() == b"precious"


def test_a_folder_of_something_else_is_left_alone(
    fit: Fit, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "configs").mkdir()
    (tmp_path / "configs" / "config.yaml").write_text("precious")
    assert fit(tmp_path / "configs", "--trainer.max_steps=1") == 2
    assert "configs holds files that are not those of a run" in capsys.readouterr().err
    assert (tmp_path / "configs" / "config.yaml").read_text() == "precious"


def test_a_file_in_the_place_of_the_run_gets_a_sentence(
    fit: Fit, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "run").write_text("precious")
    assert fit(tmp_path / "run", "--trainer.max_steps=1") == 2
    assert str(tmp_path / "run") in capsys.readouterr().err


def test_configured_callbacks_run_beside_our_own(fit: Fit, tmp_path: Path) -> None:
    stop = "--trainer.callbacks.init_args"
    own = ("--trainer.callbacks+=EarlyStopping", f"{stop}.monitor=val/loss")
    assert fit(tmp_path, *own, f"{stop}.divergence_threshold=0", "--trainer.max_epochs=3") == 0
    assert max(losses(tmp_path)) == 3  # the first epoch's last step


def test_a_missing_checkpoint_is_an_error(
    fit: Fit, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for path in (str(tmp_path / "absent.ckpt"), "last"):
        assert fit(tmp_path / "run", f"--ckpt_path={path}") == 2
        assert f"There is no checkpoint {path}" in capsys.readouterr().err
    assert not (tmp_path / "run").exists()


@pytest.mark.parametrize("command", ["validate", "test"])
def test_evaluation_refuses_to_run_untrained(
    command: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main([command, "--config=configs/quick.yaml"]) == 2
    assert "--ckpt_path" in capsys.readouterr().err


def test_evaluation_runs_a_checkpoint(fit: Fit, tmp_path: Path) -> None:
    run = tmp_path / "run"
    assert fit(run, "--trainer.max_epochs=1") == 0
    again = tmp_path / "again"
    small = [f"--run={again}", "--config", str(run / "config.yaml")]
    for command in ("validate", "test"):
        arguments = [command, *small, f"--ckpt_path={run / 'best.ckpt'}"]
        assert main(arguments) == 0


@pytest.mark.parametrize("content", [b"", b"not a checkpoint", None])
def test_a_checkpoint_that_is_none_is_refused(
    fit: Fit, tmp_path: Path, content: bytes | None, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "broken.ckpt"
    if content is None:
        torch.save({"somebody": "else's"}, path)
    else:
        path.write_bytes(content)
    assert fit(tmp_path / "run", f"--ckpt_path={path}") == 2
    assert str(path) in capsys.readouterr().err


@pytest.mark.parametrize(
    ("argument", "message"),
    [
        ("--model.nonsense=1", "nonsense"),
        ("--model.learning_rate=-1", "learning_rate"),
        ("--data.init_args.batch_size=0", "batch_size"),
        ("--model.losses.pigment_l1=-3", "pigment_l1"),
        ("--data.class_path=Nothing", "class_path"),
    ],
)
def test_an_unknown_key_or_a_value_out_of_range_is_named(
    fit: Fit, tmp_path: Path, argument: str, message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert fit(tmp_path / "run", argument) == 2
    (sentence,) = capsys.readouterr().err.splitlines()
    assert sentence.startswith("train: ") and message in sentence
    assert not (tmp_path / "run").exists()


def test_a_network_without_levels_is_refused(
    fit: Fit, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert fit(tmp_path / "run", "--model.widths=[]") == 2
    assert "widths holds" in capsys.readouterr().err


def test_an_empty_configuration_is_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "empty.yaml").touch()
    assert main(["fit", f"--config={tmp_path / 'empty.yaml'}"]) == 2
    assert "--help" in capsys.readouterr().err


def test_an_unknown_preset_is_named(
    fit: Fit, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert fit(tmp_path / "run", "--model.optics=sunny") == 2
    assert "calibrated" in capsys.readouterr().err


def test_weights_to_start_from_are_their_own_argument(
    fit: Fit, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    start = tmp_path / "start.safetensors"
    SkinAutoencoder(AutoencoderConfig(widths=(4, 8))).save_pretrained(start)
    assert fit(tmp_path / "run", f"--model.weights={start}", "--trainer.max_steps=1") == 0
    other = tmp_path / "other.safetensors"
    SkinAutoencoder(AutoencoderConfig(widths=(4, 6))).save_pretrained(other)
    assert fit(tmp_path / "run2", f"--model.weights={other}") == 2
    assert "another shape" in capsys.readouterr().err


def test_weights_of_another_preset_are_refused(
    fit: Fit, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    start = tmp_path / "start.safetensors"
    SkinAutoencoder(AutoencoderConfig("paper", widths=(4, 8))).save_pretrained(start)
    assert fit(tmp_path / "run", f"--model.weights={start}") == 2
    assert "add --model.optics paper and the same for the data" in capsys.readouterr().err


def test_a_run_is_not_continued_with_another_preset(
    fit: Fit, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert fit(tmp_path / "run", "--trainer.max_steps=1") == 0
    last = tmp_path / "run" / "last.ckpt"
    presets = ("--model.optics=paper", "--data.init_args.optics=paper")
    assert fit(tmp_path / "run", f"--ckpt_path={last}", *presets) == 2
    assert "was trained with the skin of the preset measured" in capsys.readouterr().err


def test_data_of_another_preset_than_the_model_are_refused(
    fit: Fit, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert fit(tmp_path / "run", "--data.init_args.optics=paper") == 2
    assert "Add --model.optics paper" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("leak", "error_shading_covariance"),
        ("steadiness", "augmentation_consistency"),
        ("overlap", "soft_iou"),
        ("stray", "off_skin_shading"),
        ("elsewhere", "background_reconstruction"),
        ("pigments", "pigment_l1"),
        ("fractions", "pigment_mse"),
    ],
)
@pytest.mark.parametrize("by", ["flag", "yaml"])
def test_an_old_loss_is_answered_with_its_new_name(
    fit: Fit, tmp_path: Path, old: str, new: str, by: str, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "old.yaml"
    path.write_text(yaml.safe_dump({"model": {"losses": {old: 1.0}}}))
    arguments = [f"--model.losses.{old}=1"] if by == "flag" else [f"--config={path}"]
    assert fit(tmp_path / "run", *arguments) == 2
    sentence = f"'model.losses.{old}' is now called 'model.losses.{new}'; use the new name."
    assert capsys.readouterr().err == f"train: {sentence}\n"


def test_the_old_key_of_synthetic_faces_is_answered_with_the_new_one(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    text = Path("configs/portraits.yaml").read_text(encoding="utf-8")
    (tmp_path / "old.yaml").write_text(text.replace("    synthetic:", "    twin:"))
    for arguments in (
        [f"--config={tmp_path / 'old.yaml'}"],
        ["--config=configs/portraits.yaml", "--data.init_args.twin.heads=3"],
    ):
        assert main(["fit", *arguments]) == 2
        message = capsys.readouterr().err
        assert message == "train: 'twin' is now called 'synthetic'; use the new name.\n"


def test_the_old_class_of_synthetic_faces_is_answered_with_the_new_one(
    fit: Fit, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    text = Path("configs/quick.yaml").read_text(encoding="utf-8")
    (tmp_path / "old.yaml").write_text(text.replace("SyntheticFaces", "TwinFaces"))
    for arguments in (
        [f"--config={tmp_path / 'old.yaml'}"],
        ["--config=configs/quick.yaml", "--data=TwinFaces"],
    ):
        assert main(["fit", *arguments]) == 2
        message = capsys.readouterr().err
        assert message == "train: 'TwinFaces' is now called 'SyntheticFaces'; use the new name.\n"


def test_a_checkpoint_with_hyper_parameters_of_earlier_names_is_resumed(
    fit: Fit, tmp_path: Path
) -> None:
    run = tmp_path / "run"
    assert fit(run, "--trainer.max_epochs=1") == 0
    checkpoint = torch.load(run / "last.ckpt", weights_only=True)
    checkpoint["hyper_parameters"] = {"losses": {"leak": 3.0}, "_class_path": "train.TwinFaces"}
    torch.save(checkpoint, tmp_path / "old.ckpt")
    resumed = (f"--ckpt_path={tmp_path / 'old.ckpt'}", "--trainer.max_epochs=2")
    assert fit(run, *resumed) == 0
    assert max(losses(run)) == 7
