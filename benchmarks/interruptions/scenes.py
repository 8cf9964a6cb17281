"""Scenes: commands over small inputs, with results of an earlier run where they write."""

from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

from benchmarks.interruptions.files import read_losses, read_rows
from benchmarks.interruptions.inputs import write_photographs, write_scans
from benchmarks.interruptions.processes import Command

_SKINNET, _TRAIN = "skinnet.cli", "train.cli"


class Scene(NamedTuple):
    """Commands that write into a folder.

    Attributes:
        name: Its name.
        prepare: Writes the inputs into a folder.
        before: From both folders, commands whose results lie there before.
        commands: From both folders, the commands.
        resume: From both folders, the commands after a fault; the same ones by default.
        check: Checks the files of the output that grow; raises `ValueError`.
    """

    name: str
    prepare: Callable[[Path], None]
    before: Callable[[Path, Path], list[Command]]
    commands: Callable[[Path, Path], list[Command]]
    resume: Callable[[Path, Path], list[Command]] | None = None
    check: Callable[[Path], object] = lambda output: None


def _predict(*flags: str) -> Callable[[Path, Path], list[Command]]:
    def list_commands(inputs: Path, output: Path) -> list[Command]:
        where = ("-o", str(output / "maps"), "--csv", str(output / "faces.csv"))
        return [(_SKINNET, "predict", str(inputs / "photos"), *where, "--report", *flags)]

    return list_commands


def _edit(factor: str) -> Callable[[Path, Path], list[Command]]:
    def list_commands(inputs: Path, output: Path) -> list[Command]:
        where = ("-o", str(output / "edits"))
        return [(_SKINNET, "edit", str(inputs / "photos"), "--melanin", factor, *where)]

    return list_commands


def _scans(size: str, seed: str) -> Callable[[Path, Path], list[Command]]:
    def list_commands(inputs: Path, output: Path) -> list[Command]:
        scans = sorted(map(str, (inputs / "scans").glob("*.obj")))
        maps, model = output / "maps", output / "model"
        fit = ("--fit.stages", "[[500, 10, 30.0], [2000, 0, 0.1]]", "--warp.size", size)
        some = ("--appearance.samples", "3", "--appearance.seed", seed, "--joint")
        face = ("--melanin", "1.5", "-o", str(output / "edited"))
        return [
            (_SKINNET, "maps", *scans, "-o", str(maps), *fit),
            (_SKINNET, "build-model", str(maps), "-o", str(model), *some),
            (_SKINNET, "sample", str(model / "hybrid.npz"), "-n", "1", "-o", str(output / "faces")),
            (_SKINNET, "edit-maps", str(maps / "a_maps.npz"), *face),
        ]

    return list_commands


_SMALL = (
    f"--config={Path(__file__).parents[2] / 'configs' / 'quick.yaml'}",
    "--model.widths=[4,8]",
    "--data.init_args.size=16",
    "--data.init_args.batch_size=4",
    "--data.init_args.train_samples=16",
    "--data.init_args.val_samples=4",
    "--data.init_args.heads=2",
    "--data.init_args.val_heads=1",
    "--trainer.precision=32-true",
    "--trainer.accelerator=cpu",
    "--trainer.enable_progress_bar=false",
    "--trainer.enable_model_summary=false",
    "--trainer.log_every_n_steps=1",
    "--model.warmup_steps=2",
)


def _train(epochs: int, *more: str) -> Callable[[Path, Path], list[Command]]:
    def list_commands(inputs: Path, output: Path) -> list[Command]:
        heads = f"--data.init_args.geometry={output / 'heads'}"
        length = ("--trainer.max_epochs", str(epochs))
        return [(_TRAIN, "fit", *_SMALL, f"--run={output / 'run'}", heads, *length, *more)]

    return list_commands


def _resume_training(inputs: Path, output: Path) -> list[Command]:
    """Go on from the last checkpoint of the run, if it has one yet."""
    last = output / "run" / "last.ckpt"
    moved = (output / "run.1").exists()  # the earlier run, with the first step of this one
    return _train(5, *([f"--ckpt_path={last}"] if moved and last.exists() else []))(inputs, output)


def _write_photographs(inputs: Path) -> None:
    write_photographs(inputs / "photos")


def _write_scans(inputs: Path) -> None:
    write_scans(inputs / "scans")


SCENES = (
    Scene(
        "training",
        lambda folder: None,
        _train(1, "--seed_everything=5"),
        _train(5),
        _resume_training,
        lambda output: read_losses(output / "run"),
    ),
    Scene(
        "predict",
        _write_photographs,
        _predict("--no-detail"),
        _predict(),
        check=lambda output: read_rows(output / "faces.csv"),
    ),
    Scene("edit", _write_photographs, _edit("1.2"), _edit("1.5")),
    Scene("scans", _write_scans, _scans("32", "1"), _scans("48", "2")),
)
