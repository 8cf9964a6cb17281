"""An earlier run stays where it is until another one has taken its first step."""

import csv
import shutil
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import torch
import yaml
from PIL import Image
from small_runs import list_arguments, read_files

from skinnet.network import AutoencoderConfig, SkinAutoencoder, read_checkpoint
from train.cli import main
from train.synthetic.faces import SyntheticFaces
from train.task import SkinTask

Files = dict[str, bytes]


@pytest.fixture(scope="module")
def geometry(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("geometry")


@pytest.fixture(scope="module")
def trained(geometry: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A run of one epoch, which has four steps."""
    run = tmp_path_factory.mktemp("trained") / "run"
    assert main(list_arguments(run, geometry, "--trainer.max_epochs=1")) == 0
    return run


@pytest.fixture
def run(trained: Path, tmp_path: Path) -> Path:
    """A copy of that run, alone in its folder."""
    (tmp_path / "runs").mkdir()
    shutil.copytree(trained, tmp_path / "runs" / "run")
    return tmp_path / "runs" / "run"


@pytest.fixture
def fit(geometry: Path) -> Callable[..., int]:
    return lambda run, *arguments, command="fit": main(
        list_arguments(run, geometry, "--trainer.max_epochs=1", *arguments, command=command)
    )


def read_losses(run: Path) -> dict[int, float]:
    """The training losses by their step."""
    with (run / "metrics.csv").open() as file:
        rows = [row for row in csv.DictReader(file) if row["metric"] == "train/loss"]
    return {int(row["step"]): float(row["value"]) for row in rows}


def read_steps(run: Path) -> list[int]:
    """The steps of the training losses in their order."""
    return list(read_losses(run))


REFUSED = {
    "unknown key": "--model.nonsense=1",
    "value out of range": "--model.learning_rate=-1",
    "unknown data": "--data.class_path=Nothing",
    "batch of nothing": "--data.init_args.batch_size=0",
    "missing configuration": "--config=absent.yaml",
    "missing weights": "--model.weights=absent.safetensors",
    "missing checkpoint": "--ckpt_path=absent.ckpt",
    "folder as checkpoint": "--ckpt_path=configs",
    "unknown preset": "--model.optics=sunny",
    "data of another preset": "--data.init_args.optics=paper",
    "missing skins": "--data.init_args.skins=absent.npz",
    "missing model of heads": "--data.init_args.ict=absent.npz",
    "bad seed": "--seed_everything=-3",
    "bad monitor": "--trainer.callbacks={class_path: EarlyStopping, init_args: {monitor: no}}",
    "bad strategy": "--trainer.strategy=fsdp",
    "bad interval": "--trainer.val_check_interval=1000",
    "bad share": "--trainer.limit_train_batches=0.01",
    "overfit": "--trainer.overfit_batches=2",
    "barebones": "--trainer.barebones=true",
    "accumulate": "--trainer.accumulate_grad_batches=0",
    "no batches": "--trainer.limit_train_batches=0",
    "no steps": "--trainer.max_steps=0",
    "no epochs": "--trainer.max_epochs=0",
    "no time": "--trainer.max_time=00:00:00:00",
}


@pytest.mark.parametrize("argument", REFUSED.values(), ids=REFUSED.keys())
def test_a_refused_start_leaves_the_earlier_run(
    fit: Callable[..., int], run: Path, argument: str, capsys: pytest.CaptureFixture[str]
) -> None:
    before = read_files(run.parent)
    assert fit(run, argument) == 2
    assert "Traceback" not in capsys.readouterr().err
    assert read_files(run.parent) == before


@pytest.mark.parametrize("argument", ["--model.optics=sunny", "--trainer.max_time=00:00:00:00"])
def test_a_refused_start_leaves_nothing_in_a_new_place(
    fit: Callable[..., int], tmp_path: Path, argument: str
) -> None:
    assert fit(tmp_path / "new" / "run", argument) == 2
    assert list(tmp_path.iterdir()) == []


def test_refused_weights_leave_the_earlier_run(
    fit: Callable[..., int], run: Path, tmp_path: Path
) -> None:
    other = tmp_path / "other.safetensors"
    SkinAutoencoder(AutoencoderConfig(widths=(4, 6))).save_pretrained(other)
    before = read_files(run.parent)
    assert fit(run, f"--model.weights={other}") == 2
    assert read_files(run.parent) == before


@pytest.mark.parametrize("content", ["nothing", "text", "grey", "broken"])
def test_a_folder_without_faces_leaves_the_earlier_run(
    run: Path, tmp_path: Path, content: str
) -> None:
    folder = tmp_path / "photographs"
    folder.mkdir()
    if content == "text":
        (folder / "notes.txt").write_text("no picture")
    elif content == "grey":
        Image.fromarray(np.full((64, 64, 3), 128, np.uint8)).save(folder / "a.png")
    elif content == "broken":
        (folder / "a.jpg").write_bytes(b"no picture")
    before = read_files(run.parent)
    given = ("--model.weights=null", "--trainer.accelerator=cpu", "--trainer.precision=32-true")
    data = f"--data.init_args.folder={folder}"
    assert main(["fit", "--config=configs/portraits.yaml", f"--run={run}", data, *given]) == 2
    assert read_files(run.parent) == before


@pytest.mark.parametrize(
    "place",
    [
        (SyntheticFaces, "prepare_data"),
        (SyntheticFaces, "setup"),
        (SyntheticFaces, "train_dataloader"),
        (SyntheticFaces, "on_after_batch_transfer"),
        (SkinTask, "configure_optimizers"),
        (SkinTask, "on_train_batch_start"),
        (SkinTask, "training_step"),
        (SkinTask, "optimizer_step"),
    ],
    ids=lambda place: place[1],
)
@pytest.mark.parametrize("error", [RuntimeError("a bug"), KeyboardInterrupt()], ids=repr)
def test_a_crash_before_the_end_of_the_first_step_leaves_the_earlier_run(
    fit: Callable[..., int],
    run: Path,
    place: tuple[type, str],
    error: BaseException,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def crash(*_: object, **__: object) -> None:
        raise error

    monkeypatch.setattr(*place, crash)
    before = read_files(run.parent)
    # Lightning ends the process after Ctrl-C.
    with pytest.raises(SystemExit if isinstance(error, KeyboardInterrupt) else type(error)):
        fit(run)
    assert read_files(run.parent) == before


def test_a_first_loss_that_is_no_number_leaves_the_earlier_run(
    fit: Callable[..., int],
    run: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    whole = SkinTask._compute_losses

    def spoil(*arguments: object) -> object:
        readings, total, parts = whole(*arguments)  # type: ignore[arg-type]
        return readings, total * torch.nan, {name: one * torch.nan for name, one in parts.items()}

    monkeypatch.setattr(SkinTask, "_compute_losses", spoil)
    before = read_files(run.parent)
    assert fit(run) == 2
    # The last checkpoint in the folder is that of the earlier run.
    assert "ckpt_path" not in capsys.readouterr().err
    assert read_files(run.parent) == before


@pytest.mark.parametrize(
    "arguments",
    [
        ("--trainer.fast_dev_run=true",),
        ("--trainer.fast_dev_run=3",),
        ("--trainer.fast_dev_run=1", "--trainer.logger=false"),
        ("--trainer.fast_dev_run=1", "--trainer.callbacks=ModelCheckpoint"),
    ],
)
def test_a_trial_writes_nothing(
    fit: Callable[..., int], run: Path, tmp_path: Path, arguments: tuple[str, ...]
) -> None:
    before = read_files(run.parent)
    assert fit(run, *arguments) == 0
    assert read_files(run.parent) == before
    assert fit(tmp_path / "new", *arguments) == 0
    assert not (tmp_path / "new").exists()


@pytest.mark.parametrize("command", ["validate", "test"])
@pytest.mark.parametrize("trial", ["false", "true"])
def test_an_evaluation_writes_nothing(
    fit: Callable[..., int],
    run: Path,
    command: str,
    trial: str,
    capsys: pytest.CaptureFixture[str],
) -> None:
    before = read_files(run.parent)
    arguments = (f"--ckpt_path={run / 'best.ckpt'}", f"--trainer.fast_dev_run={trial}")
    assert fit(run, *arguments, command=command) == 0
    assert {"validate": "val/loss", "test": "test/loss"}[command] in capsys.readouterr().out
    assert read_files(run.parent) == before


def test_the_first_step_renames_the_earlier_run_whole(
    fit: Callable[..., int], run: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (run / "notes.txt").write_text("precious")
    before = read_files(run)
    assert fit(run, "--trainer.max_time=00:00:00:00") == 2
    assert fit(run, "--trainer.max_steps=3", "--model.learning_rate=0.005") == 0
    assert "it is kept as" in capsys.readouterr().err
    assert read_files(run.with_name("run.1")) == before
    assert read_steps(run) == [0, 1, 2]
    assert read_checkpoint(run / "last.ckpt")["global_step"] == 3
    assert yaml.safe_load((run / "config.yaml").read_text())["model"]["learning_rate"] == 0.005
    assert len(list(run.glob("events.out.tfevents.*"))) == 1
    assert not (run / "notes.txt").exists()


def test_a_new_run_has_its_curves_from_the_first_step_on(trained: Path) -> None:
    assert read_steps(trained) == [0, 1, 2, 3]
    names = {path.name for path in trained.iterdir()}
    assert {"last.ckpt", "best.ckpt", "config.yaml", "hparams.yaml", "metrics.csv"} <= names
    from tensorboard.backend.event_processing.event_accumulator import EventAccumulator

    events = EventAccumulator(str(trained)).Reload()
    assert [event.step for event in events.Scalars("train/loss")] == [0, 1, 2, 3]
    with (trained / "metrics.csv").open() as file:
        rows = [
            float(row["value"]) for row in csv.DictReader(file) if row["metric"] == "train/loss"
        ]
    values = [event.value for event in events.Scalars("train/loss")]
    assert values == pytest.approx(rows, rel=1e-5)
    assert events.Images("portraits")[0].step == 4


def test_a_run_goes_on_in_its_own_folder(fit: Callable[..., int], run: Path) -> None:
    before = (run / "metrics.csv").read_text()
    last = f"--ckpt_path={run / 'last.ckpt'}"
    assert fit(run, last, "--trainer.max_epochs=2") == 0
    assert [path.name for path in run.parent.iterdir()] == ["run"]
    assert (run / "metrics.csv").read_text().startswith(before)
    assert read_steps(run) == list(range(8))


@pytest.mark.parametrize(
    "argument",
    ["--trainer.max_epochs=1", "--trainer.max_steps=2", "--model.optics=paper", "--model.no=1"],
)
def test_a_run_that_does_not_go_on_stays_as_it_is(
    fit: Callable[..., int], run: Path, argument: str, capsys: pytest.CaptureFixture[str]
) -> None:
    before = read_files(run.parent)
    assert fit(run, f"--ckpt_path={run / 'last.ckpt'}", argument) == 2
    err = capsys.readouterr().err
    assert "trainer.max" not in argument or "last.ckpt is at step 4" in err
    assert read_files(run.parent) == before


def test_a_checkpoint_of_elsewhere_does_not_make_the_run_in_the_folder_go_on(
    fit: Callable[..., int], run: Path, trained: Path
) -> None:
    before = read_files(run)
    elsewhere = f"--ckpt_path={trained / 'last.ckpt'}"
    assert fit(run, elsewhere, "--trainer.max_epochs=2") == 0
    assert read_files(run.with_name("run.1")) == before
    assert read_steps(run) == [4, 5, 6, 7]


def test_files_of_the_user_are_never_touched(
    fit: Callable[..., int], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    own = tmp_path / "thesis"
    own.mkdir()
    (own / "chapter.tex").write_text("precious")
    assert fit(own) == 2
    assert "holds files that are not those of a run" in capsys.readouterr().err
    assert read_files(tmp_path) == {"thesis/chapter.tex": b"precious"}


def test_the_current_folder_is_not_renamed(
    run: Path,
    geometry: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    before = read_files(run.parent)
    arguments = list_arguments(Path("."), geometry)
    arguments[1] = f"--config={Path('configs/quick.yaml').resolve()}"
    monkeypatch.chdir(run)
    assert main(arguments) == 2
    assert "is the current folder" in capsys.readouterr().err
    assert read_files(run.parent) == before


def test_a_place_that_cannot_be_written_is_found_before_the_data_are_made(
    fit: Callable[..., int], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "file").write_text("precious")
    for place in (tmp_path / "file", tmp_path / "file" / "run"):
        assert fit(place) == 2
        assert str(tmp_path / "file") in capsys.readouterr().err
    assert read_files(tmp_path) == {"file": b"precious"}
