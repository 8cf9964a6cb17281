"""Every configuration runs, made small."""

from pathlib import Path

import pytest
from PIL import Image
from skimage.data import astronaut

from train.cli import main

pytestmark = pytest.mark.slow

SMALL = (
    "--model.widths=[4,8]",
    "--model.weights=null",
    "--data.init_args.size=16",
    "--data.init_args.batch_size=2",
    "--trainer.max_steps=2",
    "--trainer.check_val_every_n_epoch=1",
    "--trainer.precision=32-true",
    "--trainer.accelerator=cpu",
    "--trainer.enable_progress_bar=false",
)
PEOPLE = 3
FEW = ("train_samples=4", "val_samples=2")
HEADS = ("heads=1", "val_heads=1")


@pytest.fixture
def photographs(tmp_path: Path) -> Path:
    folder = tmp_path / "photographs"
    folder.mkdir()
    for number in range(5):
        Image.fromarray(astronaut()[:300, : 400 - number]).save(folder / f"{number}.png")
    (folder / "broken.jpg").write_bytes(b"no picture")
    return folder


def data_of(path: Path, photographs: Path, faces: Path, casts: Path) -> tuple[str, ...]:
    heads = (*HEADS, f"geometry={casts}")
    if path.stem == "fitted":
        return (*FEW, "texels=16", "shots=2", f"folder={faces}")
    if path.stem == "wide":
        heads = (*heads, "portrait_heads=1")
    if path.stem not in ("portraits", "pairs"):
        return (*FEW, *heads)
    nested = ("size=16", "batch_size=2", "val_samples=2", *heads)
    own = (f"folder={photographs}", "unreadable_share=0.2")
    if path.stem == "pairs":
        write_index(photographs)
        own = (f"folder={photographs}", "kept=1")
        nested = (*nested, "portrait_heads=1")
    return (*own, *(f"synthetic.{each}" for each in nested))


def write_index(photographs: Path) -> None:
    """Name three people, each in the same two photographs."""
    rows = [f"person{number},{number}.png,{number + 1}.png\n" for number in range(PEOPLE)]
    (photographs / "index.csv").write_text("person,first,second\n" + "".join(rows))


EXPERIMENTS = [
    path for path in sorted(Path("configs").glob("*.yaml")) if "trainer:" in path.read_text()
]


@pytest.mark.parametrize("path", EXPERIMENTS, ids=lambda path: path.stem)
def test_a_configuration_runs(
    path: Path, photographs: Path, faces: Path, casts: Path, tmp_path: Path
) -> None:
    run = tmp_path / "run"
    data = [f"--data.init_args.{each}" for each in data_of(path, photographs, faces, casts)]
    assert main(["fit", f"--config={path}", f"--run={run}", *SMALL, *data]) == 0
    assert (run / "best.ckpt").is_file()
