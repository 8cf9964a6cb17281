"""Fits the dynamic model that the library ships: `python -m train.dynamic --ict FILE`.

Resting maps are those of synthetic faces, states follow published patterns, and expressions move
the skin as ICT-FaceKit's shapes do. The sequences have noise, covered parts and lags, and the model
is fitted to them without knowing the truth, with which it is compared.
"""

import argparse
import json
import sys
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from jaxtyping import Float, Float32

from skinnet.appearance import BloodSequence, DynamicModel
from skinnet.appearance._dynamic_file import FIELD_SIZE, SHIPPED
from skinnet.appearance.dynamic import _WINDOW
from skinnet.errors import InputError
from train.dynamic.charted_faces import ChartedFaces, chart_faces
from train.dynamic.sequences import TrueModel, sample_sequence
from train.dynamic.state_patterns import ORIGIN, PATTERNS, STATES, STRETCH_SOURCE, draw_pattern
from train.dynamic.strains import draw_strains
from train.synthetic.bodies.ict_model import read_ict_model

_MOVED = 0.04
"""Least log change of an expression that the model keeps: others, such as of the gaze, do nothing
to the skin."""

_FINE = 2 * FIELD_SIZE
"""Side in texels of the maps that are fitted."""

_STEPS = 48
"""Steps in which the largest value of a shipped field is rounded, at least half as many."""

_SPREAD_STEP = 1 / 32
"""Least step of changes of the spread, which are less certain."""

_EXPRESSION_LAG = 0.5
"""Seconds in which blood follows skin that is moved; pressed skin is red again within two."""


def main(argv: Sequence[str] | None = None) -> int:
    """Fit the model, write it, and print how it compares with the truth.

    Args:
        argv: Arguments of the command; None means those of the process.

    Returns:
        The exit code, 2 for bad input.
    """
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("-o", "--output", type=Path, default=SHIPPED)
    parser.add_argument("--ict", help="File of ICT-FaceKit; without it there are no expressions.")
    parser.add_argument("--geometry", default="runs/geometry", help="Folder of the heads.")
    parser.add_argument("--faces", type=int, default=48, help="Faces that are tried.")
    parser.add_argument("--frames", type=int, default=80, help="Frames of each.")
    parser.add_argument("--seed", type=int, default=0, help="The same seed gives the same model.")
    given = parser.parse_args(argv)
    try:
        faces = chart_faces(given.faces, _FINE, given.seed, given.ict, given.geometry)
        truth = make_truth(faces, given.ict)
        model = fit_model(truth, faces, given.frames, given.seed)
        given.output.parent.mkdir(parents=True, exist_ok=True)
        model.save(given.output)
    except InputError as error:
        print(error, file=sys.stderr)
        return 2
    print(json.dumps(compare(model, truth, faces), indent=1))
    return 0


def make_truth(faces: ChartedFaces, ict: str | None) -> TrueModel:
    """Draw the states, and with ICT-FaceKit the expressions, on the faces' chart."""
    size = len(faces.angles)
    drawn = [draw_pattern(each, faces.landmarks, size) for each in PATTERNS.values()]
    names, seconds = [*PATTERNS], [each.seconds for each in PATTERNS.values()]
    mean, spread = ([*each] for each in zip(*drawn, strict=True))
    if ict is not None:
        shapes = read_ict_model(Path(ict))
        strains = draw_strains(shapes, faces.angles, faces.landmarks)
        for name, field in zip(shapes.names, strains, strict=True):
            if np.abs(field).max() > _MOVED:
                names.append(str(name))
                seconds.append(_EXPRESSION_LAG)
                mean.append(field)
                spread.append(np.zeros_like(field))
    return TrueModel(tuple(names), np.stack(mean), np.stack(spread), np.array(seconds))


def fit_model(truth: TrueModel, faces: ChartedFaces, frames: int, seed: int) -> DynamicModel:
    """Fit the model to sampled sequences of all faces."""
    sequences = [
        _sample(truth, rest, frames, np.random.default_rng([seed, number]))
        for number, rest in enumerate(faces.hemoglobin)
    ]
    known = {*truth.names}
    states = {
        name: {each: share for each, share in parts.items() if each in known}
        for name, parts in STATES.items()
    }
    sources = {name: each.source for name, each in PATTERNS.items()}
    model = DynamicModel.fit(
        sequences,
        landmarks=faces.landmarks,
        seconds=dict(zip(truth.names, truth.seconds.tolist(), strict=True)),
        states={name: parts for name, parts in states.items() if parts},
        sources=sources | {"expressions": STRETCH_SOURCE, "origin": ORIGIN},
    )
    return replace(model, mean=_round(model.mean), spread=_round(model.spread, _SPREAD_STEP))


def _round(
    fields: Float[np.ndarray, "names size size"], least: float = 0.0
) -> Float32[np.ndarray, "names size size"]:
    """Round fields to steps of their own, powers of 2 from a least one, for a small file."""
    peaks = np.maximum(np.abs(fields).max((1, 2), keepdims=True), 1e-6)
    steps = np.maximum(np.exp2(np.ceil(np.log2(peaks / _STEPS))), least)
    # Adding 0 turns -0 into 0.
    return np.asarray(np.round(fields / steps) * steps + 0, np.float32)


def _sample(
    truth: TrueModel, rest: Float[np.ndarray, "size size"], frames: int, rng: np.random.Generator
) -> BloodSequence:
    return sample_sequence(truth, rest, frames, _WINDOW * len(rest), rng)


def compare(model: DynamicModel, truth: TrueModel, faces: ChartedFaces) -> dict[str, object]:
    """Compare the fitted fields with the true ones, where most faces show skin."""
    seen = _halve(np.isfinite(faces.hemoglobin).mean(0)) > 0.5
    order = [model.names.index(name) for name in truth.names]
    fitted, true = model.mean[order][:, seen], _halve(truth.mean)[:, seen]
    return {
        "faces": len(faces.hemoglobin),
        "held_out": dict(model.errors),
        "field_rmse": float(np.sqrt(np.mean((fitted - true) ** 2))),
        "field_r": float(np.corrcoef(fitted.ravel(), true.ravel())[0, 1]),
        "spread_r": float(
            np.corrcoef(
                model.spread[order][:, seen].ravel(), _halve(truth.spread)[:, seen].ravel()
            )[0, 1]
        ),
    }


def _halve(
    fields: Float[np.ndarray, "*fields size size"],
) -> Float[np.ndarray, "*fields half half"]:
    """Mean of each two by two texels."""
    half = fields.shape[-1] // 2
    return np.asarray(fields.reshape(*fields.shape[:-2], half, 2, half, 2).mean((-3, -1)))


if __name__ == "__main__":
    sys.exit(main())
