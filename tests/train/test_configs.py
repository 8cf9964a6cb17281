"""Every configuration runs, made small."""

from pathlib import Path

import pytest
from PIL import Image
from skimage.data import astronaut

from train.cli import main

SMALL = (
    "--model.widths=[4,8]",
    "--model.weights=null",
    "--data.init_args.size=16",
    "--data.init_args.batch_size=2",
    "--trainer.max_steps=2",
    "--trainer.precision=32-true",
    "--trainer.accelerator=cpu",
    "--trainer.enable_progress_bar=false",
)
SYNTHETIC = ("--data.init_args.train_samples=4", "--data.init_args.val_samples=2")


@pytest.fixture
def photographs(tmp_path: Path) -> Path:
    folder = tmp_path / "photographs"
    folder.mkdir()
    for number in range(5):
        Image.fromarray(astronaut()[:300, : 400 - number]).save(folder / f"{number}.png")
    (folder / "broken.jpg").write_bytes(b"no picture")
    return folder


def data_of(path: Path, photographs: Path, faces: Path) -> tuple[str, ...]:
    if path.stem == "fitted":
        own = ("texels=16", "shots=2", f"folder={faces}")
        return (*SYNTHETIC, *(f"--data.init_args.{each}" for each in own))
    if path.stem != "portraits":
        return SYNTHETIC
    nested = "--data.init_args.synthetic"
    return (
        f"--data.init_args.folder={photographs}",
        "--data.init_args.unreadable_share=0.2",
        f"{nested}.size=16",
        f"{nested}.batch_size=2",
        f"{nested}.val_samples=2",
    )


EXPERIMENTS = [
    path for path in sorted(Path("configs").glob("*.yaml")) if "trainer:" in path.read_text()
]


@pytest.mark.parametrize("path", EXPERIMENTS, ids=lambda path: path.stem)
def test_a_configuration_runs(path: Path, photographs: Path, faces: Path, tmp_path: Path) -> None:
    run = tmp_path / "run"
    data = data_of(path, photographs, faces)
    assert main(["fit", f"--config={path}", f"--run={run}", *SMALL, *data]) == 0
    assert (run / "best.ckpt").is_file()
