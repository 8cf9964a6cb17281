"""What the chart in a photograph tells of its capture."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from skinnet.errors import InputError
from skinnet.images.picture import Picture
from skinnet.images.srgb import srgb_to_linear
from skinnet.inference._references.chart import Chart, require_chart_extra
from skinnet.inference._references.chart_detection import find_chart
from skinnet.inference._references.chart_fit import (
    Fit,
    find_evenly_lit,
    find_places,
    find_usable,
    fit_colours,
    fit_spectra,
    weigh_lights,
)
from skinnet.inference._references.patch_samples import PatchSamples
from skinnet.inference._references.tone_curve import ToneCurve
from skinnet.inference.capture import _MOST_COLOURED, _TO_CAMERA, Capture

Array = NDArray[np.float64]

_GREY, _BRIGHTEST = 0.4, 0.7
"""Reflectance of the grey whose colour stands for that of white, and its largest linear value."""

_MOST_CLIPPED, _LEAST_LIT = 0.4, 0.65
"""Share of the patches that may be overexposed, and share of those with one colour that must be in
one light."""

_LEAST_USABLE = 0.45
"""Share of the patches that must have one colour that is not saturated."""

_DARKEST = 0.03
"""Least linear value of the brightest patch."""

_MOST_MEAN, _MOST_ANY = 6.0, 20.0
"""Largest mean and largest single CIEDE2000 of the patches after correction."""

_MOST_COST, _LEAST_SURE = 45.0, 0.6
"""Sum of squares of a fit of light and camera above which they are not told, and probability of the
light below which it is not."""

_MOST_CHANGE = 0.06
"""Largest change of white by the neutral patches, as a logarithm."""

_LINEAR = ToneCurve(0.06, 0.15, 0.02, 0.06)
"""A tone curve with no larger parameters is none."""


class ChartReading(NamedTuple):
    """What a chart tells.

    Attributes:
        capture: The capture of the photograph as it is.
        linear_capture: That of the photograph after its tone curve is undone.
        tone: The tone curve.
        correction: From the photograph's linear light, after the tone curve is undone, to linear
            sRGB under D65 [3, 3]: colour @ correction.
        delta_e: CIEDE2000 of each patch after the correction [n]; NaN for one that was left out.
        lit: Whether each patch is in the light that most are in [n].
        light_shares: Probability of each light; empty without spectra.
    """

    capture: Capture
    linear_capture: Capture
    tone: ToneCurve
    correction: Array
    delta_e: Array
    lit: NDArray[np.bool_]
    light_shares: dict[str, float]


def read_chart(picture: Picture, chart: Chart) -> ChartReading:
    """Read the chart in a photograph.

    Raises:
        InputError: The chart is not found, cut, overexposed, too dark, half in the shade or in
            mixed light, or another one; or the extra is not installed.
    """
    who = f"The {chart.name} in {picture.name}"
    return read_samples(find_chart(picture, chart).samples, chart, who)


def read_samples(samples: PatchSamples, chart: Chart, who: str) -> ChartReading:
    """Read the colours of a chart's patches; `who` begins sentences about it."""
    _refuse_exposure(samples, chart, who)
    evenly_lit = find_evenly_lit(samples, chart)
    _refuse_shade(samples, evenly_lit, who)
    plain = fit_colours(samples, chart, evenly_lit)
    correction, delta_e = _correct(samples, chart, plain)
    _refuse_colours(delta_e, who)
    fits = [] if chart.spectra is None else fit_spectra(samples, chart, plain)
    shares = weigh_lights(fits) if fits else {}
    chosen = fits[0] if fits and fits[0].cost < _MOST_COST else plain
    white = _find_white(samples, chart, chosen)
    _refuse_cast(chosen.tone.apply(_GREY * white), who)
    shown = _tell_white(chosen.tone, white)
    told = _tell_light(chosen, shares)
    straight = _tell_white(ToneCurve(), white)
    linear_capture = told._replace(
        white_balance=straight.white_balance, exposure=straight.exposure, linear=True
    )
    capture = told._replace(white_balance=shown.white_balance, exposure=shown.exposure)
    if is_linear(chosen.tone):
        capture, tone = linear_capture, ToneCurve()
    else:
        tone = chosen.tone
    return ChartReading(capture, linear_capture, tone, correction, delta_e, evenly_lit, shares)


def is_linear(tone: ToneCurve) -> bool:
    """Whether a tone curve is none, within what a chart tells."""
    return all(abs(one) <= most for one, most in zip(tone, _LINEAR, strict=True))


def _refuse_exposure(samples: PatchSamples, chart: Chart, who: str) -> None:
    clipped, usable = int(samples.clipped.sum()), int(find_usable(samples).sum())
    if clipped > _MOST_CLIPPED * len(chart.cells):
        raise InputError(
            f"{who} is overexposed: {clipped} of its {len(chart.cells)} patches have lost their "
            "colour. Expose so that its white stays below 250 of 255."
        )
    if usable < _LEAST_USABLE * len(chart.cells):
        raise InputError(
            f"{who} cannot be read: only {usable} of its {len(chart.cells)} patches have one "
            "colour. Give a sharp picture without reflections on the chart."
        )
    if samples.linear.max() < _DARKEST:
        raise InputError(
            f"{who} is too dark: its brightest patch has {samples.linear.max():.1%} of white. Give "
            "it more light, or expose longer."
        )


def _refuse_shade(samples: PatchSamples, lit: NDArray[np.bool_], who: str) -> None:
    seen = int(find_usable(samples).sum())
    if lit.sum() < _LEAST_LIT * seen:
        raise InputError(
            f"{who} is not in one light: only {lit.sum()} of its {seen} patches are evenly lit, "
            "and the others lie in the shade, under another light or in a reflection. Photograph "
            "it in the light that falls on the face."
        )


def _refuse_colours(delta_e: Array, who: str) -> None:
    mean, most = float(np.nanmean(delta_e)), float(np.nanmax(delta_e))
    if mean > _MOST_MEAN or most > _MOST_ANY:
        raise InputError(
            f"{who} does not have the chart's colours: after correction they differ by {mean:.1f} "
            f"in the mean and {most:.1f} at most (CIEDE2000), and {_MOST_MEAN:g} and {_MOST_ANY:g} "
            "are accepted. It may be another chart, faded, or in mixed light."
        )


def _refuse_cast(grey: Array, who: str) -> None:
    red, green, blue = np.log(np.maximum(_TO_CAMERA @ srgb_to_linear(grey), 1e-3)).tolist()
    if math.hypot(red - green, blue - green) > _MOST_COLOURED:
        raise InputError(
            f"{who} is in strongly coloured light: the log R/G and log B/G of its white are "
            f"{red - green:.2f} and {blue - green:.2f}. Set the camera's white balance to the "
            "light, and photograph again."
        )


def _correct(samples: PatchSamples, chart: Chart, fit: Fit) -> tuple[Array, Array]:
    """The 3 x 3 correction, and what remains of each patch."""
    require_chart_extra()
    import colour

    observed = _straighten(samples, chart, fit)
    weights = np.sqrt(fit.trust)[:, None] / (chart.colours.mean(1, keepdims=True) + 0.05)
    correction = np.linalg.lstsq(weights * observed, weights * chart.colours, rcond=None)[0]
    found, expected = (
        colour.XYZ_to_Lab(colour.RGB_to_XYZ(each.clip(0), "sRGB"))
        for each in (observed @ correction, chart.colours)
    )
    delta_e = np.asarray(colour.delta_E(found, expected, method="CIE 2000"))
    return correction, np.where(fit.lit & ~samples.clipped, delta_e, np.nan)


def _straighten(samples: PatchSamples, chart: Chart, fit: Fit) -> Array:
    """Linear light of the patches [n, 3] as if the light were even."""
    linear = fit.tone.undo(ToneCurve().apply(samples.linear))
    return np.asarray(linear / np.exp(find_places(chart) @ fit.falloff)[:, None])


def _find_white(samples: PatchSamples, chart: Chart, fit: Fit) -> Array:
    """Linear light of a white diffuser [3], of which neutral patches tell most."""
    inputs = chart.colours if len(fit.matrix) == 3 else chart.spectra
    assert inputs is not None
    white = fit.matrix.sum(0)
    used = chart.neutral & fit.lit & ~samples.clipped & (chart.colours.mean(1) > 0.1)
    if not used.any():
        return np.asarray(white)
    seen, expected = _straighten(samples, chart, fit)[used], (inputs @ fit.matrix)[used]
    change = np.median(np.log(np.maximum(seen, 1e-4) / np.maximum(expected, 1e-4)), axis=0)
    return np.asarray(white * np.exp(change.clip(-_MOST_CHANGE, _MOST_CHANGE)))


def _tell_white(tone: ToneCurve, white: Array) -> Capture:
    """White balance and exposure as a grey shows them, through a tone curve."""
    share = min(_GREY, _BRIGHTEST / float(white.max()))
    return Capture.from_white(tone.apply(share * white), share)


def _tell_light(fit: Fit, shares: dict[str, float]) -> Capture:
    if fit.light is None or fit.camera is None or shares[fit.light] < _LEAST_SURE:
        return Capture()
    return Capture(
        light={fit.light: 1.0},
        temperature=fit.temperature,
        camera=tuple(round(float(one), 4) for one in fit.camera),
    )
