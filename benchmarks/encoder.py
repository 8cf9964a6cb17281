"""What the encoder reads on pictures that training never saw, beside what it has to beat.

    python -m benchmarks.encoder [--json]

512 renders of the photometric twin, 256 x 256, over true skin pixels and in physical units: heads,
cameras and lots of the test split, with the seeds that are written here. Rows: the training mean;
the table of skin inverted under D65 and the mean camera; Tsumura's directions, scaled best to the
truth itself; the encoder after its first stage and as it is shipped. Networks see what users'
see: the picture at their working size, and their maps brought back. Then real portraits, where
`../shared/data/faces` is there. The training mean is that of training's own first lots and
cameras, on the validation's heads at 64 px. RMSE on BioFaceNet's grid is of
2 (f / f_max)^(1/3) - 1 with f_max .43 and .07, not clipped at its ends. `reconstruction` is cut off
at 1, as a photograph is; `explained` is its error without the offset, which is the photograph by
the share that the mask leaves and so hides what is missed of the skin. `leak` is the correlation of
predicted minus true melanin with the true shading; `group_ratio` the worst skin tone's RMSE of
melanin relative to its own mean, over the best's.
"""

import platform
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np
import torch
from torch import Tensor
from torch.utils.data import DataLoader

from benchmarks.baselines import Constant, Lookup, Tsumura, means
from benchmarks.portraits import measure_portraits
from benchmarks.reader import Encoder, NetworkReader
from benchmarks.report import Results, main
from benchmarks.scene import Pixels, Scene, scene
from benchmarks.scores import Scores
from benchmarks.targets import ASKED, layout, not_beaten
from skinnet._version import __version__
from skinnet.errors import InputError
from skinnet.network import SkinAutoencoder
from skinnet.physics import SkinDecoder
from train.synthetic.faces import Lots, SyntheticFaces

SHARED = Path(__file__).parents[2] / "shared" / "data"
WEIGHTS = {"stage1": Path(__file__).parent / "stage1.safetensors", "stage2": None}
"""Weights by row; None are the shipped ones."""

Row = Callable[[Scene], Pixels]


@dataclass(frozen=True)
class TestSet:
    """Which pictures are looked at; the defaults are those of the table."""

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


def test_scenes(settings: TestSet, decoder: SkinDecoder) -> Iterator[Scene]:
    """The test pictures; each takes about a megabyte."""
    data = _twin(settings, settings.size, test=settings.heads)
    data.setup("test")
    for number, lot in enumerate(data.test_dataloader(), 1):
        yield scene(data.render(lot, "test"), decoder)
        _say(f"\rTest pictures: {number * settings.batch_size:,} drawn.")
    _say("\n")


def training_means(settings: TestSet, decoder: SkinDecoder) -> dict[str, Tensor]:
    """Means over training's first lots, with its cameras, on the heads of the validation."""
    data = _twin(settings, settings.train_size, val=settings.train_heads)
    data.setup("validate")
    lots = Lots(data.buffers["val"], "train", settings.train_samples, settings.seed)
    batches = DataLoader(lots, settings.batch_size)
    return means(scene(data.render(lot, "train"), decoder) for lot in batches)


def _twin(settings: TestSet, size: int, test: int = 1, val: int = 1) -> SyntheticFaces:
    ict = settings.ict if settings.ict and Path(settings.ict).is_file() else None
    return SyntheticFaces(
        size,
        settings.batch_size,
        val_heads=val,
        test_heads=test,
        test_samples=settings.samples,
        ict=ict,
        geometry=settings.geometry,
        seed=settings.seed,
    )


def networks() -> dict[str, SkinAutoencoder]:
    """The encoder after each stage, where its weights are there and of this version."""
    found = {}
    for name, path in WEIGHTS.items():
        try:
            found[name] = SkinAutoencoder.from_pretrained(path)
        except (InputError, RuntimeError) as error:
            _say(f"There is no row {name}: {str(error).splitlines()[0]}\n")
    return found


@torch.no_grad()
def score(rows: Mapping[str, Row], pictures: Iterable[Scene]) -> dict[str, Scores]:
    """Every row on every picture."""
    scores = {name: Scores() for name in rows}
    for number, one in enumerate(pictures, 1):
        for name, row in rows.items():
            scores[name].add(row(one), one)
        _say(f"\rBatches read: {number}.")
    _say("\n")
    return scores


def measure(
    settings: TestSet = TestSet(),
    models: Mapping[str, SkinAutoencoder] | None = None,
) -> Results:
    """Every figure, by row and column."""
    weights: dict[str, str] = {}
    if models is None:
        models = networks()
        weights = {name: model.trained_on for name, model in models.items()}
    decoder = SkinDecoder()
    mean = training_means(settings, decoder)
    pictures = list(test_scenes(settings, decoder))
    ica = Tsumura(decoder)
    for one in pictures:
        ica.learn(one)
    rows: dict[str, Row] = {"constant": Constant(mean), "lookup": Lookup(decoder), "ica": ica}
    rows |= {name: Encoder(NetworkReader(model), model.decoder) for name, model in models.items()}
    scores = score(rows, pictures)
    found: Results = dict.fromkeys(("constant", "lookup", "ica", *WEIGHTS))
    found |= {name: one.results(scores["constant"]) for name, one in scores.items()}
    return {
        **found,
        "portraits": _portraits(settings, models),
        "explained": {name: scores[name].explained.rmse for name in models},
        "groups": {name: one.by_group() for name, one in scores.items()},
        "not_beaten": not_beaten(found),
        "asked": ASKED,
        "settings": {**_settings(settings, mean, ica), "weights": weights},
    }


def _portraits(settings: TestSet, models: Mapping[str, SkinAutoencoder]) -> Results | None:
    folder, model = Path(settings.portraits), models.get("stage2")
    if model is None or not folder.is_dir():
        missing = f"{folder} is not there" if model else "there is no stage2 to read them"
        _say(f"Portraits are left out: {missing}.\n")
        return None
    return measure_portraits(folder, NetworkReader(model), model.decoder, settings.every_portrait)


def _settings(settings: TestSet, mean: Mapping[str, Tensor], ica: Tsumura) -> Results:
    return {
        **asdict(settings),
        "skinnet": __version__,
        "python": platform.python_version(),
        "torch": torch.__version__,
        "numpy": np.__version__,
        "threads": torch.get_num_threads(),
        "ict_found": bool(settings.ict) and Path(str(settings.ict)).is_file(),
        "training_mean": {name: value.tolist() for name, value in mean.items()},
        "ica_lines": ica.lines,
        "ica_shading_scale": ica.scale,
    }


def _say(text: str) -> None:
    sys.stderr.write(text)
    sys.stderr.flush()


if __name__ == "__main__":
    main(measure, __doc__ or "", layout)
