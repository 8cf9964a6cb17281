"""Compares the encoder with baselines on pictures that training never saw.

    python -m benchmarks.encoder [--json]

A test set is 512 synthetic faces of 256 x 256 pixels: heads, cameras and scene parameters of the
test split, with the seeds below, in the preset of the shipped model. Errors are over the pixels of
true skin, in physical units. The rows are:

- `wide`: the shipped encoder in captures as wide as photographs, nothing known;
- `known`: the same pictures, with white balance, light and camera given;
- `mild`: careful cameras in white light, with the same given; `mild.blind` with nothing known;
- `any`: faces and skin as people photograph them, in wide captures, nothing known;
- `fourth`: the fourth model with nothing known, on `wide` and on the mild captures of its own
  preset. In another preset its pigments are of another scale, so that only correlations count.

On mild captures with nothing known, the encoder (`stage2`) stands beside

- the mean of the training set, on the heads of the validation set at 64 pixels (`constant`);
- the table of skin colours, inverted under D65 and the mean camera (`lookup`);
- Tsumura's directions, scaled by least squares to the truth itself (`ica`);
- the encoder after stage 1, if its preset is the same.

Networks read the picture at their working size, as for users, and their maps are resized to the
picture. Real portraits follow, if there is a folder `../shared/data/faces`. `grid_rmse` is the RMSE
of 2 (f / f_max)^(1/3) - 1, with f_max .43 and .07, not clipped. `reconstruction` is clipped at 1,
as a photograph is. `explained` is its error without the offset, which would hide errors of the
skin. `leak` is the correlation of melanin's error with the true shading. `group_ratio` divides the
largest relative RMSE of melanin among skin tones by the smallest. `coverage` is how often the
face's true mean lies inside its 90 % interval, overall and by tone group; `coverage_pixels` is the
same of pixels. `stated_sd` is the median standard deviation of the logarithm that is stated of
faces.
"""

import platform
from collections.abc import Callable, Iterable, Mapping
from dataclasses import asdict, replace
from pathlib import Path

import numpy as np
import torch
from torch import Tensor

from benchmarks.baselines import Constant, Lookup, Tsumura
from benchmarks.pictures import Pictures, Pixels
from benchmarks.portraits import PIGMENTS, measure_portraits
from benchmarks.reader import Encoder, NetworkReader
from benchmarks.report import Results, main
from benchmarks.scores import Scores
from benchmarks.targets import ASKED, format_table, list_not_beaten
from benchmarks.test_sets import TestSet, average_training_set, log, render_test_set
from skinnet._version import __version__
from skinnet.errors import InputError
from skinnet.network import SkinAutoencoder
from skinnet.physics import SkinDecoder

FOLDER = Path(__file__).parent
WEIGHTS = {"stage1": FOLDER / "stage1.safetensors", "stage2": None}
"""Weights by row; None are the shipped ones."""

FOURTH = FOLDER / "fourth.safetensors"

Row = Callable[[Pictures], Pixels]
Models = Mapping[str, SkinAutoencoder]


def load_networks(weights: Path | None = None) -> dict[str, SkinAutoencoder]:
    """Load the encoder after each stage and the fourth model, if their weights can be read."""
    found = {}
    for name, path in {**WEIGHTS, "stage2": weights, "fourth": FOURTH}.items():
        try:
            found[name] = SkinAutoencoder.from_pretrained(path)
        except (InputError, RuntimeError) as error:
            log(f"There is no row {name}: {str(error).splitlines()[0]}\n")
    return found


@torch.no_grad()
def score(rows: Mapping[str, Row], pictures: Iterable[Pictures]) -> dict[str, Scores]:
    """Score every row on every picture."""
    scores = {name: Scores() for name in rows}
    for number, one in enumerate(pictures, 1):
        for name, row in rows.items():
            scores[name].add(row(one), one)
        log(f"\rBatches read: {number}.")
    log("\n")
    return scores


def measure(
    settings: TestSet | None = None,
    models: Models | None = None,
    weights: Path | None = None,
) -> Results:
    """Measure every figure, by row and column.

    Args:
        settings: The test set; by default that of the published table, in the model's preset.
        models: Networks by row; by default those that are shipped.
        weights: File that is read in place of the shipped weights.
    """
    models = load_networks(weights) if models is None else models
    settings = settings or TestSet(optics=_find_preset(models))
    models = {name: one for name, one in models.items() if _fits(name, one, settings)}
    decoder = SkinDecoder(settings.optics)
    mean = average_training_set(settings, decoder)
    found = measure_mild(settings, models, mean)
    return {
        **found,
        **measure_wide(settings, models, mean),
        "portraits": _measure_portraits(settings, models),
        "asked": ASKED,
        "settings": {
            **_describe_settings(settings, mean),
            **found["settings"],
            "weights": {name: one.trained_on for name, one in models.items() if one.trained_on},
        },
    }


def _find_preset(models: Models) -> str:
    return models["stage2"].config.optics if "stage2" in models else TestSet().optics


def _fits(name: str, model: SkinAutoencoder, settings: TestSet) -> bool:
    """Whether a network has the test set's preset; the fourth has its own test set."""
    if name == "fourth" or model.config.optics == settings.optics:
        return True
    log(f"There is no row {name}: its preset is {model.config.optics}, not {settings.optics}.\n")
    return False


def measure_mild(settings: TestSet, models: Models, mean: Mapping[str, Tensor]) -> Results:
    """Measure baselines and encoders on mild captures."""
    decoder = SkinDecoder(settings.optics)
    pictures = list(render_test_set(settings, decoder))
    ica = Tsumura(decoder)
    for one in pictures:
        ica.fit(one)
    own = {name: NetworkReader(model) for name, model in models.items() if name != "fourth"}
    rows: dict[str, Row] = {"constant": Constant(mean), "lookup": Lookup(decoder), "ica": ica}
    rows |= {name: Encoder(reader) for name, reader in own.items()}
    if "stage2" in own:
        rows["mild"] = Encoder(own["stage2"], told=True)
    scores = score(rows, pictures)
    mild, constant = scores.pop("mild", None), scores["constant"]
    found: Results = dict.fromkeys(("constant", "lookup", "ica", *WEIGHTS))
    found |= {name: one.compute_results(constant) for name, one in scores.items()}
    if mild is not None:
        blind = _describe(scores["stage2"], constant)
        found["mild"] = {**_describe(mild, constant), "blind": blind}
    return {
        **found,
        "explained": {name: scores[name].explained.rmse for name in own},
        "groups": {name: one.group_by_tone() for name, one in scores.items()},
        "not_beaten": list_not_beaten(found),
        "settings": {"ica_lines": ica.lines, "ica_shading_scale": ica.scale},
    }


def measure_wide(settings: TestSet, models: Models, mean: Mapping[str, Tensor]) -> Results:
    """Measure encoders in wide captures, and the fourth model beside them."""
    found: Results = {}
    wide = replace(settings, captures="wide")
    readers = {name: NetworkReader(model) for name, model in models.items()}
    own, fourth = readers.get("stage2"), readers.get("fourth")
    rows: dict[str, Row] = {"constant": Constant(mean)}
    if own is not None:
        rows |= {"wide": Encoder(own), "known": Encoder(own, told=True)}
        any_rows = {"constant": Constant(mean), "any": Encoder(own)}
        found |= _score_set(replace(wide, variety="any"), any_rows)
    if fourth is not None:
        rows["fourth"] = Encoder(fourth)
        its = replace(settings, optics=fourth.model.config.optics)
        found["fourth"] = {"mild": _score_set(its, {"fourth": Encoder(fourth)})["fourth"]}
    scores = _score_set(wide, rows)
    if fourth is not None:
        found["fourth"]["wide"] = scores.pop("fourth")
    return found | scores


def _score_set(settings: TestSet, rows: Mapping[str, Row]) -> Results:
    scores = score(rows, render_test_set(settings, SkinDecoder(settings.optics)))
    constant = scores.pop("constant", None)
    return {
        name: _correlate(one) if name == "fourth" or constant is None else _describe(one, constant)
        for name, one in scores.items()
    }


def _describe(scores: Scores, constant: Scores) -> Results:
    return {**scores.compute_results(constant), **scores.coverage.compute_results()}


def _correlate(scores: Scores) -> Results:
    """The columns that do not depend on the scale of the pigments."""
    found = scores.compute_results(scores)
    columns = {name: {key: found[name][key] for key in ("r_pixel", "r_image")} for name in PIGMENTS}
    return {**columns, "mask_iou": found["mask_iou"]}


def _measure_portraits(settings: TestSet, models: Models) -> Results | None:
    folder, model = Path(settings.portraits), models.get("stage2")
    if model is None or not folder.is_dir():
        missing = f"{folder} is not there" if model else "there is no stage2 to read them"
        log(f"Portraits are left out: {missing}.\n")
        return None
    return measure_portraits(folder, NetworkReader(model), model.decoder, settings.every_portrait)


def _describe_settings(settings: TestSet, mean: Mapping[str, Tensor]) -> Results:
    return {
        **asdict(settings),
        "skinnet": __version__,
        "python": platform.python_version(),
        "torch": torch.__version__,
        "numpy": np.__version__,
        "threads": torch.get_num_threads(),
        "ict_found": settings.ict_file is not None,
        "training_mean": {name: value.tolist() for name, value in mean.items()},
    }


if __name__ == "__main__":
    main(
        measure,
        __doc__ or "",
        format_table,
        paths={"weights": ".safetensors to measure instead of the shipped one"},
    )
