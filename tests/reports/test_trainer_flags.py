"""Flags that Lightning refuses get a sentence; bugs of our own keep their traceback."""

import csv
from collections.abc import Callable
from pathlib import Path

import pytest
import shape_checks
from small_runs import list_arguments

from train import refusals
from train.cli import main
from train.monitors import list_logged
from train.synthetic.faces import SyntheticFaces
from train.task import SkinTask

Fit = Callable[..., int]


@pytest.fixture(scope="module")
def geometry(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("geometry")


@pytest.fixture
def fit(geometry: Path, monkeypatch: pytest.MonkeyPatch) -> Fit:
    """Runs a small training of two epochs, four steps each, which may start no process."""

    def refuse(*_: object, **__: object) -> None:
        raise AssertionError("A process would have been started.")

    # What checks shapes in tests stands between our entries and Lightning.
    between = (*refusals._ENTRIES, shape_checks.__name__, "jaxtyping")
    monkeypatch.setattr("train.refusals._ENTRIES", between)
    for kind in ("lightning.pytorch.strategies.launchers", "lightning.fabric.strategies.launchers"):
        monkeypatch.setattr(f"{kind}.subprocess_script._launch_process_observer", refuse)
        monkeypatch.setattr(f"{kind}.subprocess_script.subprocess.Popen", refuse)
    return lambda run, *arguments: main(
        list_arguments(run, geometry, "--trainer.max_epochs=2", *arguments)
    )


def add(callback: str, **arguments: object) -> str:
    """The flag that adds a callback."""
    given = ", ".join(f"{name}: {value}" for name, value in arguments.items())
    return f"--trainer.callbacks={{class_path: {callback}, init_args: {{{given}}}}}"


# The flag, and how the sentence names it with its value.
REFUSED = [
    ("--trainer.val_check_interval=1000", "--trainer.val_check_interval 1000"),
    ("--trainer.val_check_interval=2.5", "--trainer.val_check_interval 2.5"),
    ("--trainer.val_check_interval=0", "--trainer.val_check_interval is 0"),
    ("--trainer.val_check_interval=-1", "--trainer.val_check_interval -1"),
    ("--trainer.val_check_interval=often", "--trainer.val_check_interval often"),
    ("--trainer.check_val_every_n_epoch=0", "--trainer.check_val_every_n_epoch is 0"),
    ("--trainer.check_val_every_n_epoch=-1", "--trainer.check_val_every_n_epoch is -1"),
    ("--trainer.strategy=fsdp", "--trainer.strategy fsdp"),
    ("--trainer.strategy=deepspeed", "--trainer.strategy deepspeed"),
    ("--trainer.strategy=dp", "--trainer.strategy dp"),
    ("--trainer.strategy=single_xla", "--trainer.strategy single_xla"),
    ("--trainer.accelerator=tpu", "--trainer.accelerator tpu"),
    ("--trainer.accelerator=hpu", "--trainer.accelerator hpu"),
    ("--trainer.accelerator=nonsense", "--trainer.accelerator nonsense"),
    ("--trainer.devices=0", "--trainer.devices 0"),
    ("--trainer.devices=-1", "--trainer.devices -1"),
    ("--trainer.devices=[5]", "--trainer.devices [5]"),
    ("--trainer.devices=1.5", "--trainer.devices 1.5"),
    ("--trainer.devices=nonsense", "--trainer.devices nonsense"),
    ("--trainer.devices=99999", "--trainer.devices is 99999"),
    ("--trainer.num_nodes=0", "--trainer.num_nodes 0"),
    ("--trainer.precision=16-true", "--trainer.precision is 16-true"),
    ("--trainer.precision=bf16-true", "--trainer.precision is bf16-true"),
    ("--trainer.precision=64", "--trainer.precision is 64-true"),
    ("--trainer.precision=nonsense", "nonsense"),
    ("--trainer.plugins=DoublePrecision", "--trainer.plugins DoublePrecision"),
    ("--trainer.accumulate_grad_batches=0", "--trainer.accumulate_grad_batches is 0"),
    ("--trainer.accumulate_grad_batches=2", "--trainer.accumulate_grad_batches is 2"),
    ("--trainer.barebones=true", "--trainer.barebones is true"),
    ("--trainer.overfit_batches=2", "--trainer.overfit_batches is 2"),
    ("--trainer.overfit_batches=0.5", "--trainer.overfit_batches is 0.5"),
    ("--trainer.limit_train_batches=0", "--trainer.limit_train_batches is 0"),
    ("--trainer.limit_train_batches=2.5", "--trainer.limit_train_batches 2.5"),
    ("--trainer.limit_train_batches=0.01", "--trainer.limit_train_batches 0.01"),
    ("--trainer.limit_val_batches=-1", "--trainer.limit_val_batches -1"),
    ("--trainer.limit_val_batches=0.01", "--trainer.limit_val_batches 0.01"),
    ("--trainer.gradient_clip_val=-1", "--trainer.gradient_clip_val is -1"),
    ("--trainer.gradient_clip_algorithm=value", "--trainer.gradient_clip_algorithm"),
    ("--trainer.profiler=nonsense", "--trainer.profiler nonsense"),
    ("--trainer.profiler=xla", "--trainer.profiler is xla"),
    ("--trainer.num_sanity_val_steps=-5", "--trainer.num_sanity_val_steps is -5"),
    ("--trainer.log_every_n_steps=-1", "--trainer.log_every_n_steps is -1"),
    ("--trainer.max_time=nonsense", "--trainer.max_time nonsense"),
    ('--trainer.max_time={"nonsense": 1}', "--trainer.max_time"),
    ("--trainer.max_epochs=0", "--trainer.max_epochs is 0"),
    ("--trainer.max_epochs=-5", "--trainer.max_epochs -5"),
    ("--trainer.max_epochs=-1", "--trainer.max_epochs"),
    ("--trainer.max_steps=0", "--trainer.max_steps is 0"),
    ("--trainer.max_steps=-2", "--trainer.max_steps -2"),
    ("--trainer.min_epochs=5", "--trainer.min_epochs is 5"),
    ("--trainer.min_epochs=-5", "--trainer.min_epochs is -5"),
    ("--trainer.min_steps=100", "--trainer.min_steps is 100"),
    ("--trainer.fast_dev_run=-1", "--trainer.fast_dev_run -1"),
    ("--trainer.reload_dataloaders_every_n_epochs=-1", "reload_dataloaders_every_n_epochs -1"),
    ("--trainer.enable_checkpointing=false", "--trainer.enable_checkpointing is false"),
    ("--trainer.default_root_dir=other", "--trainer.default_root_dir is other"),
    ("--trainer.model_registry=nonsense", "--trainer.model_registry is nonsense"),
    ("--trainer.logger=nonsense", "nonsense"),
    ("--trainer.callbacks=Nonsense", "Nonsense"),
    (add("EarlyStopping", monitor="nonsense"), "EarlyStopping has the monitor nonsense"),
    (add("ModelCheckpoint", monitor="val/portraits_melanin"), "val/portraits_melanin"),
    (
        add("EarlyStopping", monitor="val/loss", mode="odd"),
        "EarlyStopping: `mode` can be min, max, got odd",
    ),
    (add("ModelCheckpoint", save_top_k=-5), "ModelCheckpoint: Invalid value for save_top_k=-5"),
    (add("StochasticWeightAveraging", swa_lrs=0.1), "StochasticWeightAveraging"),
    ("--ckpt_path=last", "There is no checkpoint last"),
    ("--ckpt_path=configs", "There is no checkpoint configs"),
    ("--ckpt_path=skinnet/inference/models/skin.onnx", "skin.onnx"),
    ("--seed_everything=-3", "--seed-everything is -3"),
    ("--seed_everything=99999999999", "--seed-everything is 99999999999"),
    ("--weights_only=false", "--weights-only is false"),
    ("--run=", "--run is empty"),
]


@pytest.mark.parametrize(("argument", "named"), REFUSED)
def test_a_refused_flag_is_named_with_its_value(
    fit: Fit, tmp_path: Path, argument: str, named: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert fit(tmp_path / "run", argument) == 2
    err = capsys.readouterr().err
    (sentence,) = [line for line in err.splitlines() if line.startswith("train: ")]
    assert named in sentence and "Traceback" not in err
    assert not (tmp_path / "run").exists()


@pytest.mark.parametrize(
    ("arguments", "named"),
    [
        (("--trainer.num_nodes=2",), "MASTER_ADDR"),
        (("--trainer.strategy=ddp", "--trainer.devices=2", "--trainer.sync_batchnorm=true"), "GPU"),
        (
            (add("EarlyStopping", monitor="val/loss"), "--trainer.limit_val_batches=0"),
            "--trainer.limit_val_batches is 0",
        ),
        (("--optimizer=Adam", "--optimizer.lr=-1"), "--optimizer Adam"),
    ],
)
@pytest.mark.filterwarnings("ignore:.*will be overridden")
def test_flags_that_do_not_go_together_are_named(
    fit: Fit,
    tmp_path: Path,
    arguments: tuple[str, ...],
    named: str,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.delenv("MASTER_ADDR", raising=False)
    assert fit(tmp_path / "run", *arguments) == 2
    assert named in capsys.readouterr().err
    assert not (tmp_path / "run").exists()


@pytest.mark.parametrize(
    "place",
    [
        (SyntheticFaces, "setup"),
        (SyntheticFaces, "train_dataloader"),
        (SkinTask, "configure_optimizers"),
        (SkinTask, "training_step"),
        (SkinTask, "validation_step"),
        (SkinTask, "on_save_checkpoint"),
    ],
    ids=lambda place: place[1],
)
@pytest.mark.parametrize("error", [RuntimeError, TypeError, ValueError, ZeroDivisionError])
def test_a_bug_of_ours_keeps_its_traceback(
    fit: Fit,
    tmp_path: Path,
    place: tuple[type, str],
    error: type[Exception],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def fail(*_: object, **__: object) -> None:
        raise error("a bug")

    monkeypatch.setattr(*place, fail)
    with pytest.raises(error, match="a bug"):
        fit(tmp_path / "run", "--trainer.max_steps=1", "--trainer.val_check_interval=1")


def read_curves(run: Path) -> dict[tuple[int, str], float]:
    with (run / "metrics.csv").open() as file:
        rows = list(csv.DictReader(file))
    return {(int(row["step"]), row["metric"]): float(row["value"]) for row in rows}


def test_a_logger_of_the_user_has_the_numbers_of_our_own(fit: Fit, tmp_path: Path) -> None:
    own = tmp_path / "own"
    logger = f"--trainer.logger={{class_path: CSVLogger, init_args: {{save_dir: {own}}}}}"
    assert fit(tmp_path / "run", logger) == 0
    (table,) = own.rglob("metrics.csv")
    with table.open() as file:
        rows = [row for row in csv.DictReader(file) if row["train/loss"]]
    theirs = [float(row["train/loss"]) for row in rows]
    curves = read_curves(tmp_path / "run")
    assert theirs == pytest.approx([curves[step, "train/loss"] for step in range(8)], rel=1e-5)
    # A monitor may have every name that is logged, and no other.
    logged = {name for _, name in curves} - {"epoch", "lr-AdamW"}
    assert logged == list_logged(SyntheticFaces())


def test_a_logger_within_the_folder_of_the_run_is_refused(
    fit: Fit, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    inner = tmp_path / "run" / "csv"
    logger = f"--trainer.logger={{class_path: CSVLogger, init_args: {{save_dir: {inner}}}}}"
    assert fit(tmp_path / "run", logger) == 2
    assert "CSVLogger would write into" in capsys.readouterr().err
    assert not (tmp_path / "run").exists()


def test_without_a_logger_there_are_checkpoints_and_no_curves(fit: Fit, tmp_path: Path) -> None:
    assert fit(tmp_path / "run", "--trainer.logger=false", "--trainer.max_epochs=1") == 0
    names = {path.name for path in (tmp_path / "run").iterdir()}
    assert names == {"best.ckpt", "last.ckpt", "config.yaml", "pictures"}


def test_a_missing_best_checkpoint_is_said(
    fit: Fit, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert fit(tmp_path / "run", "--trainer.limit_val_batches=0", "--trainer.max_epochs=1") == 0
    assert "has no best.ckpt" in capsys.readouterr().err
    assert (tmp_path / "run" / "last.ckpt").is_file()
