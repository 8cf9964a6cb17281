"""Arguments of small runs of the training command."""

from pathlib import Path

SMALL = (
    "--model.widths=[4,8]",
    "--data.init_args.size=16",
    "--data.init_args.batch_size=4",
    "--data.init_args.train_samples=16",
    "--data.init_args.val_samples=4",
    "--data.init_args.test_samples=4",
    "--data.init_args.heads=2",
    "--data.init_args.val_heads=1",
    "--data.init_args.test_heads=1",
    "--trainer.precision=32-true",
    "--trainer.accelerator=cpu",
    "--trainer.enable_progress_bar=false",
    "--trainer.enable_model_summary=false",
    "--trainer.log_every_n_steps=1",
    "--model.warmup_steps=2",
)


def list_arguments(
    folder: Path, geometry: Path, *arguments: str, command: str = "fit"
) -> list[str]:
    """The arguments of a small run of `configs/quick.yaml` in a folder, with heads kept."""
    kept = f"--data.init_args.geometry={geometry}"
    return [command, "--config=configs/quick.yaml", f"--run={folder}", *SMALL, kept, *arguments]


def read_files(folder: Path) -> dict[str, bytes]:
    """Every file in a folder and what it holds."""
    files = [path for path in folder.rglob("*") if path.is_file()]
    return {str(path.relative_to(folder)): path.read_bytes() for path in files}
