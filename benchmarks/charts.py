"""Colour charts in rendered pictures: how many are found, and how well white is known.

Renders of the classic chart under 20 lights by measured cameras, tilted to 30 degrees, in uneven
light, with noise and JPEG; a third of them lies partly in the shade, and half of them have a tone
curve. Errors of white are those of R/G and B/G, the larger one, and of its luminance, in linear
light before the tone curve.
"""

import sys

import numpy as np

from benchmarks.chart_pictures import LIGHTS, View, find_white, photograph, sample_view
from benchmarks.report import Results, main
from skinnet.errors import InputError
from skinnet.images import read_picture
from skinnet.inference._references.chart import Chart, load_chart
from skinnet.inference._references.chart_reading import ChartReading, read_chart
from skinnet.inference.capture import _TO_CAMERA

_WHITE = 0.02
"""Relative error of white that is looked for."""

_BENT = 0.5
"""Share of the pictures that have a tone curve."""


def measure(pictures: int = 3) -> Results:
    """Measure charts; `pictures` is how many there are of each light."""
    chart, rng = load_chart("classic"), np.random.default_rng(0)
    rows: list[tuple[View, ChartReading | str]] = []
    for number in range(pictures):
        for place, light in enumerate(LIGHTS):
            seed = number * len(LIGHTS) + place
            view = _sample(light, rng, seed)
            rows.append((view, _read(view, chart)))
            sys.stderr.write(f"\rCharts: {len(rows)} read.")
    sys.stderr.write("\n")
    return {
        "all": _summarise(rows),
        "even": _summarise([row for row in rows if row[0].shade == 1]),
        "shaded": _summarise([row for row in rows if row[0].shade < 1]),
    }


def _sample(light: str, rng: np.random.Generator, seed: int) -> View:
    view = sample_view(light, rng, seed % 3 == 2, seed)
    if rng.random() >= _BENT:
        return view
    contrast, bend = rng.normal((0.14, 0.5), (0.05, 0.15))
    exposure = 0.8 * view.exposure  # a tone curve makes highlights brighter
    return view._replace(contrast=contrast, bend=min(bend, 0.9), exposure=exposure)


def _read(view: View, chart: Chart) -> ChartReading | str:
    picture = read_picture(photograph(view))
    try:
        return read_chart(picture, chart)
    except InputError as error:
        return str(error)


def _summarise(rows: list[tuple[View, ChartReading | str]]) -> Results:
    found = [(view, one) for view, one in rows if isinstance(one, ChartReading)]
    errors = np.array([_find_errors(view, one) for view, one in found]).reshape(-1, 2)
    named = [
        max(one.light_shares, key=one.light_shares.__getitem__)
        for view, one in found
        if view.light in one.light_shares
    ]
    truth = [view.light for view, one in found if view.light in one.light_shares]
    return {
        "pictures": len(rows),
        "found": len(found) / max(len(rows), 1),
        "white_within_2_percent": float((errors[:, 0] < _WHITE).sum() / max(len(rows), 1)),
        "white_error": _describe(errors[:, 0]),
        "exposure_error": _describe(errors[:, 1]),
        "delta_e": _describe(np.array([np.nanmean(one.delta_e) for _, one in found])),
        "lamp_named": float(np.mean([a == b for a, b in zip(named, truth, strict=True)])),
        "light_told": float(np.mean([one.capture.light is not None for _, one in found])),
    }


def _find_errors(view: View, reading: ChartReading) -> tuple[float, float]:
    white = find_white(view)
    red, green, blue = np.log(_TO_CAMERA @ white)
    told = reading.linear_capture
    apart = np.subtract(told.white_balance, (red - green, blue - green))
    luminance = np.log(white @ (0.2126, 0.7152, 0.0722))
    return float(np.abs(apart).max()), abs(told.exposure - luminance)


def _describe(errors: np.ndarray) -> Results:
    if not errors.size:
        return {"median": float("nan"), "p95": float("nan")}
    return {"median": float(np.median(errors)), "p95": float(np.percentile(errors, 95))}


if __name__ == "__main__":
    main(measure, __doc__ or "", counts={"pictures": "pictures of each light; 3 by default"})
