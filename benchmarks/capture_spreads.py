"""How much the raw colour of a person's skin varies between photographs."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from benchmarks.face_photographs import describe_colour, measure_colour
from benchmarks.repeated_faces import Shot
from benchmarks.report import Results
from skinnet.images.srgb import LUMINANCE_WEIGHTS

DARKEST = 1e-5
"""Luminance that stands for black in a logarithm."""


def describe_shots(shots: Sequence[Shot]) -> NDArray[np.float64]:
    """Measure log R/G, log B/G and log luminance of the skin in photographs [shots, 3]."""
    colours = np.stack([measure_colour(one.photograph, one.skin) for one in shots])
    return describe_light(colours)


def describe_light(linear: NDArray[np.floating]) -> NDArray[np.float64]:
    """Describe linear RGB [..., 3] by log R/G, log B/G and log luminance."""
    light = np.log(np.maximum(linear @ LUMINANCE_WEIGHTS, DARKEST))
    return np.concatenate([describe_colour(linear)[..., :2], light[..., None]], -1)


def measure_spreads(described: NDArray[np.floating]) -> Results:
    """Measure the spread of skin's colour within people over two photographs [people, 2, 3]."""
    described = described[np.isfinite(described).all((1, 2))]
    within = np.sqrt(described.var(1, ddof=1).mean(0)).tolist()
    return dict(zip(("log_rg", "log_bg", "log_luminance"), within, strict=True))
