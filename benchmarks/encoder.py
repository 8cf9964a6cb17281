"""Compares the encoder with baselines on pictures that training never saw.

    python -m benchmarks.encoder [--json]

The test set is 512 synthetic faces of 256 x 256 pixels: heads, cameras and scene parameters of the
test split, with the seeds below. Errors are over the pixels of true skin, in physical units. The
rows are:

- the mean of the training set, on the heads of the validation set at 64 pixels;
- the table of skin colours, inverted under D65 and the mean camera;
- Tsumura's directions, scaled by least squares to the truth itself;
- the encoder after stage 1, and the shipped one. Networks read the picture at their working size,
  as for users, and their maps are resized to the picture.

Real portraits follow, if there is a folder `../shared/data/faces`. `grid_rmse` is the RMSE of
2 (f / f_max)^(1/3) - 1, with f_max .43 and .07, not clipped. `reconstruction` is clipped at 1, as a
photograph is. `explained` is its error without the offset, which would hide errors of the skin.
`leak` is the correlation of melanin's error with the true shading. `group_ratio` divides the
largest relative RMSE of melanin among skin tones by the smallest.
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

from benchmarks.baselines import Constant, Lookup, Tsumura, average_skin
from benchmarks.pictures import Pictures, Pixels, collect_pictures
from benchmarks.portraits import measure_portraits
from benchmarks.reader import Encoder, NetworkReader
from benchmarks.report import Results, main
from benchmarks.scores import Scores
from benchmarks.targets import ASKED, format_table, list_not_beaten
from skinnet._version import __version__
from skinnet.errors import InputError
from skinnet.network import SkinAutoencoder
from skinnet.physics import SkinDecoder
from train.synthetic.faces import SyntheticFaces, SyntheticScenes

SHARED = Path(__file__).parents[2] / "shared" / "data"
WEIGHTS = {"stage1": Path(__file__).parent / "stage1.safetensors", "stage2": None}
"""Weights by row; None are the shipped ones."""

Row = Callable[[Pictures], Pixels]


@dataclass(frozen=True)
class TestSet:
    """Sizes and sources of the pictures; the defaults are those of the published table."""

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
    optics: str = "calibrated"


def render_test_set(settings: TestSet, decoder: SkinDecoder) -> Iterator[Pictures]:
    """Render the test set; a picture takes about a megabyte."""
    data = _make_faces(settings, settings.size, test=settings.heads)
    data.setup("test")
    for number, scenes in enumerate(data.test_dataloader(), 1):
        yield collect_pictures(data.render(scenes, "test"), decoder)
        _log(f"\rTest pictures: {number * settings.batch_size:,} rendered.")
    _log("\n")


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
        optics=settings.optics,
    )


def load_networks() -> dict[str, SkinAutoencoder]:
    """Load the encoder after each stage, if its weights can be read."""
    found = {}
    for name, path in WEIGHTS.items():
        try:
            found[name] = SkinAutoencoder.from_pretrained(path)
        except (InputError, RuntimeError) as error:
            _log(f"There is no row {name}: {str(error).splitlines()[0]}\n")
    return found


@torch.no_grad()
def score(rows: Mapping[str, Row], pictures: Iterable[Pictures]) -> dict[str, Scores]:
    """Score every row on every picture."""
    scores = {name: Scores() for name in rows}
    for number, one in enumerate(pictures, 1):
        for name, row in rows.items():
            scores[name].add(row(one), one)
        _log(f"\rBatches read: {number}.")
    _log("\n")
    return scores


def measure(
    settings: TestSet = TestSet(),
    models: Mapping[str, SkinAutoencoder] | None = None,
) -> Results:
    """Measure every figure, by row and column."""
    weights: dict[str, str] = {}
    if models is None:
        models = load_networks()
        weights = {name: model.trained_on for name, model in models.items()}
    _check_preset(settings, models)
    decoder = SkinDecoder(settings.optics)
    mean = average_training_set(settings, decoder)
    pictures = list(render_test_set(settings, decoder))
    ica = Tsumura(decoder)
    for one in pictures:
        ica.fit(one)
    rows: dict[str, Row] = {"constant": Constant(mean), "lookup": Lookup(decoder), "ica": ica}
    rows |= {name: Encoder(NetworkReader(model), model.decoder) for name, model in models.items()}
    scores = score(rows, pictures)
    found: Results = dict.fromkeys(("constant", "lookup", "ica", *WEIGHTS))
    found |= {name: one.compute_results(scores["constant"]) for name, one in scores.items()}
    return {
        **found,
        "portraits": _measure_portraits(settings, models),
        "explained": {name: scores[name].explained.rmse for name in models},
        "groups": {name: one.group_by_tone() for name, one in scores.items()},
        "not_beaten": list_not_beaten(found),
        "asked": ASKED,
        "settings": {**_describe_settings(settings, mean, ica), "weights": weights},
    }


def _check_preset(settings: TestSet, models: Mapping[str, SkinAutoencoder]) -> None:
    for name, model in models.items():
        if (preset := model.config.optics) != settings.optics:
            raise InputError(
                f"{name} was trained with the preset {preset} and the pictures have the skin of "
                f"{settings.optics}; give both the same."
            )


def _measure_portraits(settings: TestSet, models: Mapping[str, SkinAutoencoder]) -> Results | None:
    folder, model = Path(settings.portraits), models.get("stage2")
    if model is None or not folder.is_dir():
        missing = f"{folder} is not there" if model else "there is no stage2 to read them"
        _log(f"Portraits are left out: {missing}.\n")
        return None
    return measure_portraits(folder, NetworkReader(model), model.decoder, settings.every_portrait)


def _describe_settings(settings: TestSet, mean: Mapping[str, Tensor], ica: Tsumura) -> Results:
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


def _log(text: str) -> None:
    sys.stderr.write(text)
    sys.stderr.flush()


if __name__ == "__main__":
    main(measure, __doc__ or "", format_table)
