"""Fits light, camera, tone curve and shading to the colours of a chart."""

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

from skinnet.images.srgb import LUMINANCE_WEIGHTS
from skinnet.inference._references.chart import Chart
from skinnet.inference._references.patch_samples import PatchSamples
from skinnet.inference._references.shade import find_lit
from skinnet.inference._references.spectral_camera import (
    COMPONENTS,
    list_lights,
    make_light,
    make_matrix,
    make_sensitivity,
)
from skinnet.inference._references.tone_curve import ToneCurve

Array = NDArray[np.float64]

_SD = 0.018
"""Standard deviation of the error of a patch's colour in display sRGB."""

_OUTLIER, _ROUNDS = 3.0, 4
"""Error, in standard deviations, at which a patch loses half of its weight; rounds of weighting."""

_UNEVEN, _LIT = 0.15, 0.18
"""Relative spread within a patch from which a shadow's edge crosses it, and how much the logarithm
of the light on a patch may differ from that on the others."""

_STEPS, _FEW_STEPS, _FINALISTS = 40, 5, 3
"""Largest number of steps of a fit; that of the first fit of each light; and lights that are fitted
to the end."""

_TONE, _TONE_SD = np.array((0.07, 0.25, 0.0, 0.04)), np.array((0.12, 0.3, 0.015, 0.08))
"""Prior of contrast, bend, flare and saturation: between linear light and usual photographs."""

_TONE_RANGE = np.array((-0.4, -0.6, 0.0, -0.4)), np.array((0.7, 0.95, 0.1, 0.5))
_FALLOFF_SD = 0.15
"""Change of the light's logarithm over half the chart."""

_BALANCE_SD = 0.25
_MIRED, _MIRED_SD, _MIRED_RANGE = 165.0, 35.0, (41.0, 249.0)
_DAYLIGHT = 0.75
"""Share of photographs in daylight; the lamps share the rest."""


class Fit(NamedTuple):
    """A chart's photograph, explained.

    Attributes:
        tone: The tone curve.
        matrix: From what describes a patch, its colour or its spectrum, to linear light [k, 3].
        falloff: Change of the light's logarithm over half the chart, across and down.
        lit: Whether each patch is in the light that most are in [n].
        trust: Weight of each patch in [0, 1]; low for one in the shade [n].
        cost: Sum of squares, in standard deviations, with that of the prior.
        balance: Logarithms of the errors in R/G and B/G; None without spectra.
        light: Name of the light; None without spectra.
        temperature: Of daylight, in kelvin; None for lamps, and without spectra.
        camera: Coefficients of the camera basis; None without spectra.
    """

    tone: ToneCurve
    matrix: Array
    falloff: Array
    lit: NDArray[np.bool_]
    trust: Array
    cost: float
    balance: tuple[float, float] | None = None
    light: str | None = None
    temperature: float | None = None
    camera: Array | None = None


class _Model(NamedTuple):
    """Parameters beyond tone and falloff: start, prior, range, and the matrix that they make."""

    start: Array
    mean: Array
    sd: Array
    low: Array
    high: Array
    make: Callable[[Array], Array]
    inputs: Array


def find_usable(samples: PatchSamples) -> NDArray[np.bool_]:
    """Find the patches [n] that are neither saturated nor crossed by a shadow's edge."""
    return np.asarray((samples.spread < _UNEVEN) & ~samples.clipped)


def find_evenly_lit(samples: PatchSamples, chart: Chart) -> NDArray[np.bool_]:
    """Find the usable patches [n] in the light that most are in."""
    observed, usable = ToneCurve(*_TONE).undo(_encode(samples)), find_usable(samples)
    shade = find_lit(observed, chart.colours, find_places(chart), usable)
    return np.asarray(usable & (np.abs(shade) < _LIT))


def fit_colours(samples: PatchSamples, chart: Chart, lit: NDArray[np.bool_]) -> Fit:
    """Fit a 3 x 3 matrix from the colours of the lit patches to linear light."""
    observed = ToneCurve(*_TONE).undo(_encode(samples))
    start = np.linalg.lstsq(chart.colours[lit], observed[lit], rcond=None)[0]
    flat, free = np.asarray(start, float).ravel(), np.full(9, np.inf)
    model = _Model(flat, flat, free, -free, free, _make_square, chart.colours)
    return _fit(model, samples, chart, lit, saturated=False)[0]


def fit_spectra(samples: PatchSamples, chart: Chart, plain: Fit) -> list[Fit]:
    """Fit each light, with a camera, to the spectra of the patches; the likeliest first.

    Args:
        samples: Colours of the patches.
        chart: A chart with spectra.
        plain: The fit of a matrix, whose choice of patches is taken over.
    """
    quick = {name: _fit_light(name, samples, chart, plain, _FEW_STEPS) for name in list_lights()}
    order = sorted(quick, key=lambda name: quick[name].cost)
    best = {name: _fit_light(name, samples, chart, plain, _STEPS) for name in order[:_FINALISTS]}
    return sorted((quick | best).values(), key=lambda fit: fit.cost)


def weigh_lights(fits: list[Fit]) -> dict[str, float]:
    """Posterior probability of each light."""
    shares = np.exp(-0.5 * (np.array([fit.cost for fit in fits]) - fits[0].cost))
    return {
        str(fit.light): float(share) for fit, share in zip(fits, shares / shares.sum(), strict=True)
    }


def _make_square(each: Array) -> Array:
    return each.reshape(3, 3)


def _fit_light(name: str, samples: PatchSamples, chart: Chart, plain: Fit, steps: int) -> Fit:
    assert chart.spectra is not None
    day = name == "D"
    exposure = math.log(max(float(plain.matrix.sum(0) @ LUMINANCE_WEIGHTS), 1e-3))
    mean = np.r_[np.zeros(COMPONENTS + 2), exposure, 0.0]
    sd = np.r_[np.ones(COMPONENTS), _BALANCE_SD, _BALANCE_SD, np.inf, 1.0]
    warm = np.array(_MIRED_RANGE) - _MIRED
    reach = np.r_[np.full(COMPONENTS, 4.0), 1.5, 1.5, 4.0]
    low, high = np.r_[-reach, warm[0] / _MIRED_SD], np.r_[reach, warm[1] / _MIRED_SD]
    if not day:
        sd[-1] = 1e-3

    def make(each: Array) -> Array:
        light = make_light(name, 1e6 / (_MIRED + _MIRED_SD * each[-1]))
        sensitivity = make_sensitivity(each[:COMPONENTS])
        balance = float(each[COMPONENTS]), float(each[COMPONENTS + 1])
        return math.exp(each[COMPONENTS + 2]) * make_matrix(light, sensitivity, balance)

    model = _Model(mean, mean, sd, low, high, make, chart.spectra)
    fit, found = _fit(model, samples, chart, plain.lit, saturated=True, start=plain, steps=steps)
    prior = _DAYLIGHT if day else (1 - _DAYLIGHT) / (len(list_lights()) - 1)
    return fit._replace(
        cost=fit.cost - 2 * math.log(prior),
        light=name,
        temperature=1e6 / (_MIRED + _MIRED_SD * float(found[-1])) if day else None,
        camera=found[:COMPONENTS],
        balance=(float(found[COMPONENTS]), float(found[COMPONENTS + 1])),
    )


def _fit(
    model: _Model,
    samples: PatchSamples,
    chart: Chart,
    lit: NDArray[np.bool_],
    saturated: bool,
    start: Fit | None = None,
    steps: int = _STEPS,
) -> tuple[Fit, Array]:
    rounds = _ROUNDS if start is None else 1
    display = _encode(samples)
    place = find_places(chart)
    tone_sd = np.where((True, True, True, saturated), _TONE_SD, 1e-4)
    tone_mean = np.where((True, True, True, saturated), _TONE, 0.0)
    mean = np.r_[tone_mean, 0, 0, model.mean]
    sd = np.r_[tone_sd, _FALLOFF_SD, _FALLOFF_SD, model.sd]
    low = np.r_[_TONE_RANGE[0], -1, -1, model.low]
    high = np.r_[_TONE_RANGE[1], 1, 1, model.high]

    def predict(each: Array) -> Array:
        shade = np.exp(place @ each[4:6])[:, None]
        return ToneCurve(*each[:4]).apply(shade * (model.inputs @ model.make(each[6:])))

    def residual(each: Array) -> Array:
        errors = (predict(each) - display) / _SD * np.sqrt(trust)[:, None]
        return np.concatenate([errors.ravel(), (each - mean) / sd])

    first = np.r_[np.maximum(tone_mean, (0, 0, 0.003, 0)), 0, 0, model.start]
    if start is not None:
        first[:6] = np.r_[np.array(start.tone[:3]), tone_mean[3], start.falloff]
    trust = lit.astype(float)
    for last in range(rounds):
        first = first.clip(low + 1e-6, high - 1e-6)
        found = least_squares(residual, first, bounds=(low, high), max_nfev=steps)
        first = found.x
        errors = np.sqrt(np.mean(((predict(first) - display) / _SD) ** 2, 1))
        if last < rounds - 1:
            trust = lit / (1 + (errors / _OUTLIER) ** 2)
    tone = ToneCurve(*map(float, first[:4]))
    fit = Fit(tone, model.make(first[6:]), first[4:6], lit, trust, 2 * float(found.cost))
    return fit, first[6:]


def find_places(chart: Chart) -> Array:
    """Where patches lie [n, 2], from -1 to 1 across and down."""
    half = np.maximum((np.array(chart.shape) - 1) / 2, 0.5)
    return np.asarray((chart.cells - half) / half)


def _encode(samples: PatchSamples) -> Array:
    return ToneCurve().apply(samples.linear)
