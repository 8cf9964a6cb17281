"""Sclera beside the templates of London, and regions in two portraits of the same people.

    python -m benchmarks.face_parts [--json] [--every N]

`sclera` is over the 63 faces of London: `inside` is the part of its pixels that lies inside the
templates' eyes, `beside_iris` the part that also lies outside their irises, and `found` the part of
the templates' sclera that it covers. `r_over_g` and `b_over_g` are its linear chromaticity relative
to that of the grey wall, as medians over faces, and `cheek_r_over_g` is that of the cheeks.

`agreement` is over people with two portraits by different photographers: Spearman's correlation
between both portraits of people's median melanin and hemoglobin in a region, and beside it that of
all visible skin (`all`) of the same people. `cheeks` is the mean of both. --every N takes every
Nth person and face.
"""

import csv
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw
from scipy.stats import spearmanr

from benchmarks.face_landmarks import EYES
from benchmarks.portrait_faces import read_template
from benchmarks.portraits import measure_wall
from benchmarks.report import Results, main
from skinnet import Decomposer, Decomposition
from skinnet.errors import InputError
from skinnet.images import read_photo, srgb_to_linear
from skinnet.inference.decomposition import SKIN_THRESHOLD

FOLDER = Path(__file__).parents[2] / "shared" / "data" / "faces"

IRISES = (tuple(range(2, 10)), tuple(range(10, 18)))
"""Points of a template on the contours of irises."""

PIGMENTS = ("melanin", "hemoglobin")
CHEEKS = ("left_cheek", "right_cheek")

Medians = dict[str, tuple[float, float]]
"""Melanin and hemoglobin by region; NaN where a region is hidden."""


def measure(every: int = 1) -> Results:
    """Measure both."""
    decomposer = Decomposer(threads=1)
    return {
        "sclera": measure_sclera(sorted((FOLDER / "london").glob("*.jpg"))[::every], decomposer),
        "agreement": measure_agreement(list(read_pairs(every, decomposer))),
    }


def measure_sclera(paths: Sequence[Path], decomposer: Decomposer) -> Results:
    """Measure where the sclera of portraits with templates is, and its colour."""
    counts, colours = np.zeros(4), []
    for path in paths:
        photo = read_photo(path)
        face = decomposer(photo, detail=False)
        template = read_template(path.with_suffix(".tem"))
        eyes, irises = (fill(template, outlines, photo.shape) for outlines in (EYES, IRISES))
        sclera = face.sclera
        parts = sclera, sclera & eyes, sclera & eyes & ~irises, eyes & ~irises
        counts += [part.sum() for part in parts]
        cheeks = face.region_mask(CHEEKS[0]) | face.region_mask(CHEEKS[1])
        colours.append([compare(photo[sclera], photo), compare(photo[cheeks], photo)])
    found, inside, beside, true = counts.tolist()
    (red, blue), (cheek_red, _) = np.nanmedian(colours, 0).tolist()
    return {
        "inside": inside / found,
        "beside_iris": beside / found,
        "found": beside / true,
        "r_over_g": red,
        "b_over_g": blue,
        "cheek_r_over_g": cheek_red,
    }


def fill(
    template: NDArray[np.floating], outlines: Sequence[Sequence[int]], shape: tuple[int, ...]
) -> NDArray[np.bool_]:
    """Fill outlines through points of a template."""
    image = Image.new("1", (shape[1], shape[0]))
    draw = ImageDraw.Draw(image)
    for outline in outlines:
        draw.polygon([(x, y) for x, y in template[list(outline)].tolist()], fill=1)
    return np.array(image)


def compare(pixels: NDArray[np.uint8], photo: NDArray[np.uint8]) -> list[float]:
    """Linear R/G and B/G of some pixels of a photograph, relative to those of its wall."""
    if not len(pixels):
        return [np.nan, np.nan]
    red, green, blue = (srgb_to_linear(pixels).mean(0) / measure_wall(photo)).tolist()
    return [red / green, blue / green]


def read_pairs(every: int, decomposer: Decomposer) -> Iterator[tuple[Medians, Medians]]:
    """Read both portraits of people; those of whom one cannot be read are left out."""
    folder = FOLDER / "congress_pairs"
    with (folder / "index.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))[::every]
    for number, row in enumerate(rows, 1):
        print(f"\rPairs: {number:,}. ", end="", file=sys.stderr)
        try:
            first, second = (decomposer(folder / row[name]) for name in ("first", "second"))
        except InputError:
            continue
        yield take_medians(first), take_medians(second)
    print(file=sys.stderr)


def take_medians(face: Decomposition) -> Medians:
    """Medians of both pigments in each region, and in all skin."""
    medians: Medians = {}
    for name, region in face.regions.items():
        values = region.melanin.median, region.hemoglobin.median
        melanin, hemoglobin = (np.nan if value is None else value for value in values)
        medians[name] = melanin, hemoglobin
    left, right = (np.array(medians[cheek]) for cheek in CHEEKS)
    medians["cheeks"] = tuple(((left + right) / 2).tolist())
    skin = face.mask > SKIN_THRESHOLD
    medians["all"] = float(np.median(face.melanin[skin])), float(np.median(face.hemoglobin[skin]))
    return medians


def measure_agreement(pairs: Sequence[tuple[Medians, Medians]]) -> Results:
    """Correlate the medians of both portraits over people, by region."""
    found: Results = {"people": len(pairs)}
    whole = np.array([[one["all"] for one in pair] for pair in pairs])
    for name in pairs[0][0]:
        values = np.array([[one[name] for one in pair] for pair in pairs])
        seen = np.isfinite(values).all((1, 2)) & np.isfinite(whole).all((1, 2))
        found[name] = {"people": int(seen.sum())}
        for index, pigment in enumerate(PIGMENTS):
            found[name][pigment] = correlate(values[seen, :, index])
            found[name][f"{pigment}_of_all"] = correlate(whole[seen, :, index])
    return found


def correlate(values: NDArray[np.floating]) -> float:
    """Spearman's correlation of two columns."""
    return float(spearmanr(values[:, 0], values[:, 1]).statistic)


if __name__ == "__main__":
    main(measure, __doc__ or "", counts={"every": "take every Nth person and face"})
