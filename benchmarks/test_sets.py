"""Synthetic test sets of the encoder, and the mean of its training set."""

import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from torch import Tensor
from torch.utils.data import DataLoader

from benchmarks.baselines import average_skin
from benchmarks.pictures import Pictures, collect_pictures
from skinnet.physics import SkinDecoder
from train.synthetic.faces import SyntheticFaces, SyntheticScenes
from train.synthetic.variety import Captures, Variety

SHARED = Path(__file__).parents[2] / "shared" / "data"


@dataclass(frozen=True)
class TestSet:
    """Sizes and sources of the pictures; the defaults are those of the published table."""

    # Not a test of pytest's.
    __test__ = False

    size: int = 256
    heads: int = 128
    samples: int = 512
    train_size: int = 64
    train_heads: int = 32
    train_samples: int = 512
    ict: str | None = str(SHARED / "models" / "ict_facekit.npz")
    geometry: str = "runs/geometry"
    seed: int = 0
    batch_size: int = 16
    portraits: str = str(SHARED / "faces")
    every_portrait: int = 1
    optics: str = "measured"
    captures: Captures = "mild"
    variety: Variety = "mild"

    @property
    def ict_file(self) -> str | None:
        """The file of ICT-FaceKit, if it is there."""
        return find_ict(self.ict)


def find_ict(path: str | None) -> str | None:
    """Return the path of ICT-FaceKit's file, if it is there."""
    return path if path and Path(path).is_file() else None


def render_test_set(settings: TestSet, decoder: SkinDecoder) -> Iterator[Pictures]:
    """Render the test set; a picture takes about a megabyte."""
    data = _make_faces(settings, settings.size, test=settings.heads)
    data.setup("test")
    for number, scenes in enumerate(data.test_dataloader(), 1):
        yield collect_pictures(data.render(scenes, "test"), decoder)
        log(f"\rTest pictures: {number * settings.batch_size:,} rendered.")
    log("\n")


def average_training_set(settings: TestSet, decoder: SkinDecoder) -> dict[str, Tensor]:
    """Average the first scenes of training, on the heads of the validation set."""
    data = _make_faces(settings, settings.train_size, val=settings.train_heads)
    data.setup("validate")
    dataset = SyntheticScenes(data.buffers["val"], "train", settings.train_samples, settings.seed)
    batches = DataLoader(dataset, settings.batch_size)
    return average_skin(
        collect_pictures(data.render(scenes, "train"), decoder) for scenes in batches
    )


def _make_faces(settings: TestSet, size: int, test: int = 1, val: int = 1) -> SyntheticFaces:
    return SyntheticFaces(
        size,
        settings.batch_size,
        val_heads=val,
        test_heads=test,
        test_samples=settings.samples,
        ict=settings.ict_file,
        geometry=settings.geometry,
        seed=settings.seed,
        optics=settings.optics,
        variety=settings.variety,
        captures=settings.captures,
    )


def log(text: str) -> None:
    """Report progress."""
    sys.stderr.write(text)
    sys.stderr.flush()
