"""Finds a colour chart in a photograph, and the colours of its patches."""

import warnings
from collections.abc import Iterator
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from skinnet.errors import InputError
from skinnet.images.box import Box
from skinnet.images.picture import Picture
from skinnet.images.resizing import resize
from skinnet.images.srgb import srgb_to_linear
from skinnet.inference._references.chart import Chart, require_chart_extra
from skinnet.inference._references.lattice import Lattice, find_lattices
from skinnet.inference._references.patch_samples import (
    PatchSamples,
    apply_homography,
    sample_patches,
)

Array = NDArray[np.float64]

_WIDTHS = 1440, 2400, 800
"""Widths, in pixels, at which a chart is looked for, until it is found."""

_LEAST_INSIDE = 0.4
"""Share of the patches that must be in the photograph."""

_MOST_MISFIT, _LEAST_MARGIN = 0.8, 1.25
"""Largest relative residual of the chart's colours in the place where it is taken to be, and least
ratio of the next best one to it."""

_LEAST_MEMBERS = 0.6
"""Share of the patches of which a grid is taken for a chart, even if its colours are others."""

_ROUNDS = 4
"""Rounds of weighted least squares, in which patches in the shade lose weight."""

_REFINED = 0.3
"""Distance from its cell, in cells, within which a quadrilateral is a patch."""


class FoundChart(NamedTuple):
    """A chart in a photograph.

    Attributes:
        samples: Colours of the patches.
        corners: Columns and rows [4, 2] of the corners of all patches, from the upper left one of
            the chart, clockwise.
    """

    samples: PatchSamples
    corners: Array


class _Placement(NamedTuple):
    misfit: float
    homography: Array


def find_chart(picture: Picture, chart: Chart) -> FoundChart:
    """Find a chart.

    Raises:
        InputError: It is not found, or cut; or the detector is not installed.
    """
    photo = picture.srgb
    upright = photo.shape[1] < photo.shape[0]
    srgb = np.rot90(photo) if upright else photo
    most = 0
    for width in _WIDTHS:
        placement, members = _find_at_width(srgb, chart, width)
        most = max(most, members)
        if placement is not None:
            break
    else:
        raise InputError(_explain_absence(picture.name, chart, most))
    homography = placement.homography
    if upright:  # turned back
        homography = np.array([[0, -1, photo.shape[1]], [1, 0, 0], [0, 0, 1.0]]) @ homography
    return _read_chart(picture, chart, homography)


def _explain_absence(name: str, chart: Chart, most: int) -> str:
    if most >= _LEAST_MEMBERS * len(chart.cells):
        return (
            f"The grid of {most} patches in {name} does not have the colours of a {chart.name}. It "
            "may be another chart (--chart names one), or lie in mixed light or half in the shade."
        )
    return (
        f"No {chart.name} was found in {name}. It must be whole, sharp, lit by one light, and at "
        "least a sixth of the picture wide; --chart names another chart."
    )


def _read_chart(picture: Picture, chart: Chart, homography: Array) -> FoundChart:
    columns, rows = chart.shape
    corners = np.array([(0.0, 0), (columns, 0), (columns, rows), (0, rows)])
    corners = apply_homography(homography, corners)
    height, width = picture.pixels.shape[:2]
    low = np.floor(corners.min(0)).astype(int).clip(0)
    right, bottom = np.ceil(corners.max(0)).astype(int).clip(0, (width, height)).tolist()
    box = Box(int(low[0]), int(low[1]), right, bottom)
    part = replace(picture, pixels=picture.pixels[box.slices], alpha=None)
    shift = np.array([[1.0, 0, -box.left], [0, 1, -box.top], [0, 0, 1]])
    samples = sample_patches(part.linear(), shift @ homography, chart.cells)
    outside = int(np.isnan(samples.linear).any(1).sum())
    if outside:
        raise InputError(
            f"The {chart.name} in {picture.name} is cut: {outside} of its {len(chart.cells)} "
            "patches are not in the picture. Give a picture of the whole chart."
        )
    return FoundChart(samples, corners)


def _find_at_width(
    srgb: NDArray[np.uint8], chart: Chart, width: int
) -> tuple[_Placement | None, int]:
    """The place of the chart, and the number of members of the largest grid."""
    height = max(1, round(srgb.shape[0] * width / srgb.shape[1]))
    small = resize(np.ascontiguousarray(srgb), width, height)
    linear = srgb_to_linear(small)
    scale = np.diag((srgb.shape[1] / width, srgb.shape[0] / height, 1.0))
    lattices = find_lattices(_find_quads(small, chart))
    most = max((len(lattice.cells) for lattice in lattices), default=0)
    for lattice in lattices:
        placement = _place(lattice, linear, chart)
        if placement is not None:
            return placement._replace(homography=scale @ placement.homography), most
    return None, most


def _find_quads(srgb: NDArray[np.uint8], chart: Chart) -> Array:
    """Quadrilaterals [n, 4, 2] that may be patches, in pixels."""
    detector = require_chart_extra()
    scale = srgb.shape[1] / _WIDTHS[0]
    with np.errstate(all="ignore"), warnings.catch_warnings():  # a picture of one colour
        warnings.simplefilter("ignore")
        found = detector.segmenter_default(
            srgb.astype(np.float32) / 255,
            apply_cctf_encoding=False,
            additional_data=True,
            working_width=srgb.shape[1],
            swatches=len(chart.cells),
            swatch_minimum_area_factor=200 * scale**2,
        )
    return np.asarray(found.swatches, float).reshape(-1, 4, 2) + 0.5


def _place(lattice: Lattice, linear: NDArray[np.float32], chart: Chart) -> _Placement | None:
    """The best place of a chart on a grid; None if its colours fit nowhere."""
    homography = _fit_homography(lattice)
    if homography is None:
        return None
    places = [
        _Placement(_measure_misfit(linear, homography @ turned, chart), homography @ turned)
        for turned in _list_turns(lattice, chart)
    ]
    best, second = sorted([*places, _Placement(np.inf, homography)], key=lambda one: one.misfit)[:2]
    if best.misfit > _MOST_MISFIT or second.misfit < _LEAST_MARGIN * best.misfit:
        return None
    return best


def _fit_homography(lattice: Lattice) -> Array | None:
    """From columns and rows to pixels [3, 3]."""
    import cv2

    if (np.ptp(lattice.cells, axis=0) < 1).any():
        return None
    side = float(np.hypot(*np.ptp(lattice.centres, 0)) / np.hypot(*np.ptp(lattice.cells, 0)))
    found, _ = cv2.findHomography(
        lattice.cells + 0.5, lattice.centres, cv2.RANSAC, _REFINED / 3 * side
    )
    return None if found is None else np.asarray(found, float)


def _list_turns(lattice: Lattice, chart: Chart) -> Iterator[Array]:
    """Where a chart may lie on a grid: matrices [3, 3] from its columns and rows to the grid's."""
    extent = lattice.cells.max(0) + 1
    columns, rows = chart.shape
    for quarter in range(4):
        c, s = ((1, 0), (0, 1), (-1, 0), (0, -1))[quarter]
        width, height = (columns, rows) if quarter % 2 == 0 else (rows, columns)
        back = np.array([[c, -s], [s, c]]) @ (columns / 2, rows / 2)
        for left in _list_offsets(int(extent[0]), width):
            for top in _list_offsets(int(extent[1]), height):
                shift = (left + width / 2, top + height / 2) - back
                yield np.array([[c, -s, shift[0]], [s, c, shift[1]], [0, 0, 1.0]])


def _list_offsets(found: int, wanted: int) -> range:
    """Offsets at which one interval contains the other."""
    return range(min(0, found - wanted), max(0, found - wanted) + 1)


def _measure_misfit(linear: NDArray[np.float32], homography: Array, chart: Chart) -> float:
    """Relative median residual of the chart's colours, up to a linear map, in one place."""
    observed = sample_patches(linear, homography, chart.cells).linear
    seen = ~np.isnan(observed).any(1)
    if seen.mean() < _LEAST_INSIDE:
        return np.inf
    weights = 1 / (chart.colours[seen].mean(1, keepdims=True) + 0.05)
    left, right = weights * observed[seen], weights * chart.colours[seen]
    trust = np.ones((len(left), 1))
    for _ in range(_ROUNDS):
        solution = np.linalg.lstsq(trust * left, trust * right, rcond=None)[0]
        residual = np.linalg.norm(left @ solution - right, axis=1, keepdims=True)
        middle = float(np.median(residual))
        trust = 1 / np.sqrt(1 + (residual / (2 * middle + 1e-9)) ** 2)
    degrees = 1 - solution.shape[0] / len(left)
    spread = float(np.median(np.linalg.norm(right - np.median(right, 0), axis=1)))
    return float(middle / spread / max(degrees, 0.1))
