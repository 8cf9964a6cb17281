"""Colour scales are even in lightness, have labels that fit, and show pale and dark skin alike."""

from pathlib import Path

import colour
import numpy as np
import pytest

from skinnet import Decomposer
from skinnet.inference import _colour_scales
from skinnet.inference._colour_scales import HEMOGLOBIN, MELANIN, Scale
from skinnet.inference.decomposition import SKIN_THRESHOLD
from skinnet.physics import F_BLOOD_RANGE, F_MEL_RANGE

SCALES = {name: one for name, one in vars(_colour_scales).items() if isinstance(one, Scale)}
each_scale = pytest.mark.parametrize("scale", SCALES.values(), ids=SCALES)


def compute_lab(scale: Scale, values: np.ndarray) -> np.ndarray:
    return colour.XYZ_to_Lab(colour.sRGB_to_XYZ(scale.colour(values) / 255))


@each_scale
def test_lightness_changes_evenly_and_in_one_direction(scale: Scale) -> None:
    lab = colour.XYZ_to_Lab(colour.sRGB_to_XYZ(scale.ramp(np.linspace(0, 1, 101)) / 255))
    lightness = lab[:, 0]
    steps = np.diff(lightness) * np.sign(lightness[-1] - lightness[0])
    assert steps.min() > 0.3 and np.ptp(lightness) > 90
    assert np.abs(lightness - np.linspace(lightness[0], lightness[-1], 101)).max() < 4


@each_scale
def test_values_are_placed_in_order_from_end_to_end(scale: Scale) -> None:
    top = scale.ticks[-1] / scale.factor
    places = scale.place(np.linspace(0, top, 1001))
    assert places[0] == 0 and places[-1] == pytest.approx(1) and (np.diff(places) > 0).all()
    assert (scale.colour(np.array([top, 9 * top])) == scale.colours[-1]).all()
    assert (scale.colour(np.array([-1.0])) == scale.colours[0]).all()


@pytest.mark.parametrize("scale", [MELANIN, HEMOGLOBIN])
def test_equal_ratios_are_equal_distances_above_the_knee(scale: Scale) -> None:
    places = scale.place(np.array([0.02, 0.04, 0.08, 0.16]))
    np.testing.assert_allclose(np.diff(places), places[1] - places[0])
    knee = scale.knee / scale.factor
    below, at, above = scale.place(knee * np.array([0.999, 1, 1.001]))
    assert at - below == pytest.approx(above - at, rel=2e-3)


@pytest.mark.parametrize(
    ("scale", "highest"), [(MELANIN, F_MEL_RANGE[1]), (HEMOGLOBIN, F_BLOOD_RANGE[1])]
)
def test_the_fractions_of_skin_are_on_the_scale(scale: Scale, highest: float) -> None:
    assert highest < scale.ticks[-1] / scale.factor


@pytest.mark.parametrize("melanin", [0.015, 0.03, 0.06, 0.12, 0.25])
def test_a_spot_is_seen_on_pale_and_on_dark_skin(melanin: float) -> None:
    skin, spot = compute_lab(MELANIN, melanin * np.array([1, 1.6]))
    assert colour.delta_E(skin, spot, method="CIE 2000") > 6
    assert skin[0] - spot[0] > 7


def test_people_of_all_tones_are_told_apart() -> None:
    lightness = compute_lab(MELANIN, np.array([0.015, 0.03, 0.06, 0.12, 0.24, 0.4]))[:, 0]
    assert (np.diff(lightness) < -8).all()


def test_labels_are_in_percent() -> None:
    labels, places = zip(*MELANIN.label(), strict=True)
    assert labels == ("0", "1", "2", "5", "10", "20", "50 %")
    np.testing.assert_allclose(places, MELANIN.place(np.array([0, 1, 2, 5, 10, 20, 50]) / 100))


@pytest.mark.slow
@pytest.mark.parametrize("person", ["132", "001", "008", "137"])
def test_palest_and_darkest_faces_show_their_pattern(shared_data: Path, person: str) -> None:
    read = Decomposer(threads=1)(shared_data / f"faces/london/{person}_03.jpg", detail=False)
    melanin = np.percentile(read.melanin[read.mask > SKIN_THRESHOLD], [2.5, 97.5])
    first, last = compute_lab(MELANIN, melanin)
    assert first[0] - last[0] > 5
    assert colour.delta_E(first, last, method="CIE 2000") > 5
