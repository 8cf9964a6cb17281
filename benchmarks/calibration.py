"""Calibration: how well a known colour transform is recovered, and whether the claim holds.

`python -m benchmarks.calibration [--json]`. 36 trials have known transforms: 20,000 colours from
all, the paler or the darker half of the model's colours, with relative noise of .2, .5 or 1 %, two
transforms and two seeds each. 14 trials have 25 synthetic people each, the first those of
`examples.lightstage`, painted on the face model's texture chart in 8-bit sRGB; brows, lashes and
lips are among their colours. `error` and `uncertainty` are relative, in the Frobenius norm.
`covered` is the share of trials whose error is at most the claimed uncertainty. A refusal counts
as an error of 1 that no claim covers. `lines` counts the room without the exposure.
"""

import time
from collections.abc import Iterable, Iterator, Sequence
from functools import cache
from pathlib import Path
from typing import NamedTuple

import numpy as np
import torch
from jaxtyping import Bool, Float
from scipy.interpolate import CubicSpline

from benchmarks.report import Results, main
from examples.lightstage import CAMERA, FILTER, LIGHT, paint_person
from skinnet import InputError, calibration
from skinnet.appearance.colour import SkinColour
from skinnet.calibration import calibrate
from skinnet.images import linear_to_srgb, srgb_to_linear, to_uint8
from skinnet.physics import SkinLookup, SkinReflectance, load_spectrum_to_srgb
from skinnet.pipeline import ColourSettings
from skinnet.shape import load_shape_model
from skinnet.texture import TextureSpace

MIX = np.array([[0.8, 0.05, 0.01], [0.03, 0.86, 0.04], [0.01, 0.06, 0.92]])
BRIGHT = np.array([[1.6, -0.05, 0.03], [0.02, 1.3, -0.04], [-0.005, 0.01, 1.1]])
COVERS = {
    "all": ((0, 1), (0, 1)),
    "paler": ((0, 0.5), (0, 1)),
    "darker": ((0.5, 1), (0, 1)),
    "less blood": ((0, 1), (0, 0.5)),
    "more blood": ((0, 1), (0.5, 1)),
}
"""Ranges of melanin and of blood, as shares of the rows and columns of the model's grid."""

MEASURED_COVERS = ("all", "paler", "darker")
NOISES = (0.002, 0.005, 0.01)
SEEDS, CROWDS, PEOPLE = 2, 14, 25
COLOURS, TEXELS = 20_000, 256


class Trial(NamedTuple):
    """The error of one calibration, what it claims, and the seconds that it takes."""

    error: float
    uncertainty: float
    seconds: float
    refused: bool = False


@cache
def model_colours() -> Float[np.ndarray, "mel blood 3"]:
    """The colours of skin under D65 over melanin and blood, a grid."""
    matrix = load_spectrum_to_srgb("D65", "mean")
    lookup = SkinLookup(SkinReflectance(dtype=torch.float64), (64, 64))
    table = lookup.colours(matrix[None])[0].movedim(0, -1).numpy()
    mel, blood = (lookup.fractions(axis).numpy() for axis in (0, 1))
    return table[np.ix_((mel > 0.005) & (mel < 0.43), (blood > 0.005) & (blood < 0.15))]


def known_colours(
    transform: Float[np.ndarray, "3 3"],
    cover: str = "all",
    noise: float = 0.005,
    seed: int = 0,
    count: int = COLOURS,
) -> Float[np.ndarray, "colours 3"]:
    """Transformed colours of a part of the model, at nodes or between, with relative noise."""
    rng = np.random.default_rng(seed)
    grid = model_colours()
    rows, columns = (
        np.linspace(low * (size - 1), high * (size - 1), 300)
        for (low, high), size in zip(COVERS[cover], grid.shape, strict=False)
    )
    fine = CubicSpline(np.arange(len(grid)), grid)(rows)
    fine = CubicSpline(np.arange(grid.shape[1]), fine, axis=1)(columns)
    colours = rng.choice(fine.reshape(-1, 3), count) @ transform.T
    return np.asarray(colours * (1 + noise * rng.normal(size=colours.shape)))


@cache
def chart(texels: int) -> Bool[np.ndarray, "texels texels"]:
    """The texels of the face model's own texture coordinates."""
    model = load_shape_model()
    assert model.uv is not None and model.uv_triangles is not None
    return TextureSpace(model.uv, model.uv_triangles, texels).mask


def crowd_colours(
    crowd: int, count: int, matrix: Float[np.ndarray, "wavelength 3"], texels: int = TEXELS
) -> Float[np.ndarray, "colours 3"]:
    """Colours of a crowd of people in the lightstage, about `count` of all together."""
    rng = np.random.default_rng(crowd)
    colour, mask = SkinColour(matrix, FILTER), chart(texels)
    each = []
    for number in range(PEOPLE):
        truth = paint_person(PEOPLE * crowd + number, PEOPLE, texels)
        texel = rng.choice(np.flatnonzero(mask), count // PEOPLE)
        f_mel, f_blood, cover = (
            torch.from_numpy(truth[name].ravel()[texel]) for name in ("f_mel", "f_blood", "cover")
        )
        paint = torch.from_numpy(truth["paint"].reshape(3, -1)[:, texel])
        rgb = (1 - cover) * colour.skin(f_mel[None], f_blood[None])[0] + cover * paint
        each.append(srgb_to_linear(to_uint8(linear_to_srgb(rgb.T.numpy()))))
    return np.concatenate(each).astype(np.float64)


def attempt(
    colours: Float[np.ndarray, "colours 3"],
    model: Float[np.ndarray, "mel blood 3"],
    known: Float[np.ndarray, "3 3"],
    seed: int,
) -> Trial:
    """One calibration of colours whose transform is known."""
    start = time.perf_counter()
    try:
        found = calibrate(colours, model, seed)
    except InputError:
        return Trial(1.0, 0.0, time.perf_counter() - start, refused=True)
    seconds = time.perf_counter() - start
    error = float(np.linalg.norm(found.transform - known) / np.linalg.norm(known))
    return Trial(error, found.uncertainty, seconds)


def known_trials(cover: str, noise: float, seeds: int, count: int = COLOURS) -> Iterator[Trial]:
    """Trials of both transforms."""
    for transform in (MIX, BRIGHT):
        for seed in range(seeds):
            data = known_colours(transform, cover, noise, seed, count)
            yield attempt(data, model_colours(), transform, seed)


def crowd_trials(crowds: int, count: int) -> Iterator[Trial]:
    """Trials of people, under the light and camera of the example."""
    matrix = load_spectrum_to_srgb(LIGHT, CAMERA).numpy()
    model = ColourSettings(LIGHT, CAMERA)._tabulate_model(matrix)
    for crowd in range(crowds):
        yield attempt(crowd_colours(crowd, count, matrix), model, FILTER, crowd)


def summarise(trials: Iterable[Trial]) -> Results:
    """One row of the table."""
    trials = list(trials)
    error, uncertainty, seconds, refused = np.array(trials).T
    return {
        "trials": len(trials),
        "error": float(np.median(error)),
        "worst_error": float(error.max()),
        "uncertainty": float(np.median(uncertainty)),
        "covered": float(np.mean(error <= uncertainty)),
        "refused": int(refused.sum()),
        "seconds": float(np.median(seconds)),
    }


def measure(
    covers: Sequence[str] = MEASURED_COVERS,
    noises: Sequence[float] = NOISES,
    seeds: int = SEEDS,
    crowds: int = CROWDS,
    count: int = COLOURS,
) -> Results:
    """Every figure, by name."""
    rows = {
        f"{cover}_{100 * noise:g}%": list(known_trials(cover, noise, seeds, count))
        for cover in covers
        for noise in noises
    }
    rows["people"] = list(crowd_trials(crowds, 5 * count))
    every = [trial for row in rows.values() for trial in row]
    return {
        **{name: summarise(row) for name, row in rows.items()},
        "example_error": rows["people"][0].error,
        "trials": len(every),
        "coverage": summarise(every)["covered"],
        "lines": lines_of_code(),
    }


def lines_of_code() -> int:
    """Lines of the room, without those of the exposure."""
    files = Path(calibration.__path__[0]).glob("*.py")
    return sum(
        len(file.read_text(encoding="utf-8").splitlines())
        for file in files
        if "exposure" not in file.name
    )


def layout(results: Results) -> str:
    """The rows as a table in Markdown, and the figures of all trials below."""
    names = ("error", "worst_error", "uncertainty", "covered", "refused", "seconds")
    head = ["| data | " + " | ".join(names) + " |", "|" + "---|" * (len(names) + 1)]
    rows = [
        f"| {name} | " + " | ".join(f"{row[column]:.3g}" for column in names) + " |"
        for name, row in results.items()
        if isinstance(row, dict)
    ]
    rest = [
        f"{name}: {value:.3g}" for name, value in results.items() if not isinstance(value, dict)
    ]
    return "\n".join([*head, *rows, "", *rest])


if __name__ == "__main__":
    main(measure, "Known colour transforms recovered by calibration.", layout)
