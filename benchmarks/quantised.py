"""Size, speed and error of the shipped files in int8 and half precision, against float32.

    python -m benchmarks.quantised [--json]

The test is 64 synthetic faces of 160 x 160 pixels on 16 procedural heads of the test split; static
quantisation takes its ranges from 64 faces on 16 heads of the validation split. For each way:

- `megabytes`; `milliseconds` of one face on one thread, the shortest of many runs that alternate
  between all ways in one process; `times_faster` is the ratio to float32;
- `melanin` and `hemoglobin`: RMSE from float32 over the skin of all faces, as a share of the mean;
- `melanin_of_face`, `hemoglobin_of_face`: the median change of a face's mean, as a share;
- `melanin_from_truth`: RMSE from the true melanin, a volume fraction;
- `mask_iou`, with float32's mask; `astronaut_melanin` and `astronaut_hemoglobin`, the change of the
  mean that `Decomposer` reads in that photograph, on float32's skin, as a share.

The decoder's error is the RMSE of its picture, sRGB in [0, 1], from float32's.
"""

import time
from collections.abc import Callable, Mapping
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, NamedTuple

import numpy as np
import torch
from numpy.typing import NDArray
from skimage.data import astronaut

from benchmarks.report import Results, main
from export.quantisation import halve, quantise_dynamically, quantise_statically
from skinnet.inference import (
    CAPTURE_NAMES,
    MAP_NAMES,
    SHIPPED_ENCODER,
    Decomposer,
    OnnxModel,
    open_model,
)
from skinnet.inference._onnx_pair import get_decoder_path
from train.batch import Batch
from train.synthetic.faces import SyntheticFaces

SIZE, BATCH, ROUNDS = 160, 16, 30
PIGMENTS = ("melanin", "hemoglobin")
DECODERS = ("float32", "dynamic", "static")

Arrays = dict[str, NDArray[Any]]


class Faces(NamedTuple):
    """Photographs, uint8 sRGB [faces, h, w, 3], their true melanin and skin, [faces, h, w]."""

    photographs: NDArray[np.uint8]
    melanin: NDArray[np.float32]
    skin: NDArray[np.bool_]

    @property
    def feeds(self) -> list[Arrays]:
        """The encoder's inputs, one face each."""
        return [{"image": photograph[None]} for photograph in self.photographs]


def render_faces(geometry: Path, split: str, heads: int, count: int) -> Faces:
    """Render faces of the validation or the test split, in the shipped model's preset."""
    data = SyntheticFaces(
        SIZE,
        BATCH,
        **{f"{split}_heads": heads, f"{split}_samples": count},
        geometry=str(geometry),
        optics=open_model(SHIPPED_ENCODER, "encoder").optics,
    )
    data.setup({"val": "validate", "test": "test"}[split])
    loader = {"val": data.val_dataloader, "test": data.test_dataloader}[split]()
    parts = [_collect(data.render(scenes, split)) for scenes in loader]
    return Faces(*(np.concatenate(each) for each in zip(*parts, strict=True)))


def _collect(batch: Batch) -> tuple[NDArray[Any], ...]:
    assert batch.truth is not None
    eight_bits = (255 * batch.photograph).round().to(torch.uint8).movedim(1, -1)
    return eight_bits.numpy(), batch.truth.melanin.numpy(), batch.mask.numpy() > 0.5


def write_variants(folder: Path, calibration: Faces) -> dict[str, Path]:
    """Write each way's encoder, and a decoder beside it."""
    maps = [
        _decoder_inputs(one)
        for one in run_all(open_model(SHIPPED_ENCODER, "encoder"), calibration.feeds)
    ]
    ways: Mapping[str, Callable[[Path, Path, list[Arrays]], None]] = {
        "float32": lambda source, target, _: _copy(source, target),
        "float16": lambda source, target, _: halve(source, target),
        "dynamic": lambda source, target, _: quantise_dynamically(source, target),
        "dynamic_uint8": lambda source, target, _: quantise_dynamically(source, target, False),
        "static": quantise_statically,
    }
    paths = {name: folder / f"{name}.onnx" for name in ways}
    for name, path in paths.items():
        ways[name](SHIPPED_ENCODER, path, calibration.feeds)
        # The physics of the decoder needs float32.
        way = ways["float32" if name == "float16" else name]
        way(get_decoder_path(SHIPPED_ENCODER), get_decoder_path(path), maps)
    return paths


def _copy(source: Path, target: Path) -> None:
    target.write_bytes(source.read_bytes())


def run_all(model: OnnxModel, feeds: list[Arrays]) -> list[Arrays]:
    """Run a model on each input."""
    return [model.run(feed) for feed in feeds]


def _decoder_inputs(outputs: Arrays) -> Arrays:
    return {name: outputs[name] for name in (*MAP_NAMES, *CAPTURE_NAMES)}


def time_all(models: Mapping[str, OnnxModel], feed: Arrays, rounds: int) -> Results:
    """Measure the shortest time of each model; their runs alternate."""
    shortest = dict.fromkeys(models, np.inf)
    for _ in range(rounds):
        for name, model in models.items():
            started = time.perf_counter()
            model.run(feed)
            shortest[name] = min(shortest[name], time.perf_counter() - started)
    first = next(iter(shortest.values()))
    return {
        name: {"milliseconds": seconds * 1e3, "times_faster": first / seconds}
        for name, seconds in shortest.items()
    }


def compare(before: list[Arrays], after: list[Arrays], faces: Faces) -> Results:
    """Compare an encoder's outputs with float32's and with the truth."""
    skin = [one["mask"][0] > 0.5 for one in before]
    found: Results = {}
    for pigment in PIGMENTS:
        old, new = (
            [one[pigment][0][where] for one, where in zip(outputs, skin, strict=True)]
            for outputs in (before, after)
        )
        error = np.concatenate(new) - np.concatenate(old)
        found[pigment] = float(np.sqrt((error**2).mean()) / np.concatenate(old).mean())
        changes = [abs(b.mean() / a.mean() - 1) for a, b in zip(old, new, strict=True) if a.size]
        found[f"{pigment}_of_face"] = float(np.median(changes))
    melanin = np.concatenate([one["melanin"] for one in after])
    error = melanin[faces.skin] - faces.melanin[faces.skin]
    masks = np.concatenate([one["mask"] for one in after]) > 0.5
    return {
        **found,
        "melanin_from_truth": float(np.sqrt((error**2).mean())),
        "mask_iou": float((masks & np.stack(skin)).sum() / (masks | np.stack(skin)).sum()),
    }


def measure(heads: int = 16, count: int = 64, rounds: int = ROUNDS) -> Results:
    """Measure every way, encoder and decoder."""
    with TemporaryDirectory() as name:
        folder = Path(name)
        calibration = render_faces(folder, "val", heads, count)
        faces = render_faces(folder, "test", heads, count)
        paths = write_variants(folder, calibration)
        return {
            "encoder": measure_encoders(paths, faces, rounds),
            "decoder": measure_decoders(paths, faces, rounds),
        }


def measure_encoders(paths: Mapping[str, Path], faces: Faces, rounds: int) -> Results:
    """Measure each encoder."""
    models = {name: open_model(path, "encoder", 1) for name, path in paths.items()}
    outputs = {name: run_all(model, faces.feeds) for name, model in models.items()}
    times = time_all(models, faces.feeds[0], rounds)
    read = {name: Decomposer(path, 1)(astronaut(), detail=False) for name, path in paths.items()}
    skin = read["float32"].mask > 0.5
    means = {
        name: {p: getattr(one, p)[skin].mean() for p in PIGMENTS} for name, one in read.items()
    }
    return {
        name: {
            "megabytes": path.stat().st_size / 1e6,
            **times[name],
            **compare(outputs["float32"], outputs[name], faces),
            **{
                f"astronaut_{pigment}": float(mean / means["float32"][pigment] - 1)
                for pigment, mean in means[name].items()
            },
        }
        for name, path in paths.items()
    }


def measure_decoders(paths: Mapping[str, Path], faces: Faces, rounds: int) -> Results:
    """Measure each decoder on the maps of float32's encoder."""
    files = {name: get_decoder_path(paths[name]) for name in DECODERS}
    models = {name: open_model(path, "decoder", 1) for name, path in files.items()}
    encoder = open_model(paths["float32"], "encoder", 1)
    maps = [_decoder_inputs(one) for one in run_all(encoder, faces.feeds)]
    times = time_all(models, maps[0], rounds)
    images = {name: run_all(model, maps) for name, model in models.items()}
    errors = {
        name: [a["image"] - b["image"] for a, b in zip(found, images["float32"], strict=True)]
        for name, found in images.items()
    }
    return {
        name: {
            "megabytes": path.stat().st_size / 1e6,
            **times[name],
            "image": float(np.sqrt(np.mean(np.square(errors[name])))),
        }
        for name, path in files.items()
    }


if __name__ == "__main__":
    main(measure, __doc__ or "")
