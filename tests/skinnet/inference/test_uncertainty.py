"""Intervals hold what they promise, and standard deviations are those of the fractions."""

from dataclasses import replace

import numpy as np
import pytest

from skinnet import Decomposer, Decomposition
from skinnet.errors import InputError
from skinnet.images import resize
from skinnet.inference._uncertainty import find_factor, find_interval


@pytest.mark.parametrize("level", [0.5, 0.9, 0.99])
def test_an_interval_holds_the_truth_with_its_level(level: float) -> None:
    rng = np.random.default_rng(0)
    truth = 0.03 * np.exp(0.25 * rng.standard_normal(40_000))
    low, high = find_interval(0.03, 0.25, 0.43, level)
    assert ((low < truth) & (truth < high)).mean() == pytest.approx(level, abs=0.01)
    assert low < 0.03 < high and low * high == pytest.approx(0.03**2)


def test_an_interval_ends_with_the_range() -> None:
    assert find_interval(0.3, 1.0, 0.43, 0.9)[1] == 0.43
    assert find_interval(0.3, 0.0, 0.43) == (0.3, 0.3)


@pytest.mark.parametrize("level", [0.0, 1.0, -0.1, 90.0, float("nan")])
def test_a_level_that_is_no_probability_is_refused(
    level: float, decomposition: Decomposition
) -> None:
    with pytest.raises(InputError, match=r"probability between 0 and 1; got .* nine of ten"):
        decomposition.interval(level)


def test_the_interval_is_that_of_the_mean(decomposition: Decomposition) -> None:
    skin = decomposition.mask > 0.5
    for (name, ends), log_sd in zip(decomposition.interval(0.8).items(), (0.1, 0.2), strict=True):
        mean = getattr(decomposition, name)[skin].mean(dtype=float)
        assert decomposition.means[name] == pytest.approx(mean)
        factor = np.exp(1.2815516 * log_sd)
        assert ends == pytest.approx((mean / factor, mean * factor), rel=1e-6)
    assert find_factor(0.1, 0.8) == pytest.approx(np.exp(0.12815516))


def test_maps_are_fractions_times_the_deviation_of_their_logarithm(
    decomposition: Decomposition,
) -> None:
    box = decomposition.box
    for name in ("melanin", "hemoglobin"):
        map_, values = getattr(decomposition, f"{name}_sd"), getattr(decomposition, name)
        log_sd = resize(decomposition.uncertainty.of_pixels(name), box.width, box.height)
        assert map_.shape == values.shape and map_.dtype == np.float32
        np.testing.assert_allclose(map_[box.slices], values[box.slices] * log_sd, rtol=1e-5)
        outside = np.ones(map_.shape, bool)
        outside[box.slices] = False
        assert not map_[outside].any() and map_[box.slices].any()
        np.testing.assert_array_equal(decomposition.maps()[f"{name}_sd"], map_)


def test_the_summary_says_how_sure_it_is(decomposition: Decomposition) -> None:
    summary = decomposition.summary()
    for name, log_sd in (("melanin", 0.1), ("hemoglobin", 0.2)):
        pigment = summary["pigments"][name]
        assert pigment["mean"] == summary["maps"][name]["mean"] and pigment["level"] == 0.9
        assert pigment["sd"] == pytest.approx(log_sd * pigment["mean"], rel=1e-4)
        assert pigment["interval"] == pytest.approx(decomposition.interval()[name], rel=1e-4)
        of_pixels = summary["maps"][f"{name}_sd"]
        assert of_pixels["unit"] == summary["maps"][name]["unit"] and of_pixels["mean"] > 0
    assert summary["capture_known"] == []


def test_without_skin_nothing_is_sure(decomposition: Decomposition) -> None:
    bare = replace(decomposition, mask=0 * decomposition.mask)
    assert bare.means == bare.interval() == {}
    expected = {"mean": None, "sd": None, "interval": None, "level": 0.9}
    assert bare.summary()["pigments"] == {"melanin": expected, "hemoglobin": expected}


def test_a_turned_head_has_its_own_uncertainty(
    decomposer: Decomposer, astronaut: np.ndarray
) -> None:
    upright = decomposer(astronaut, detail=False)
    turned = decomposer(np.rot90(astronaut).copy(), detail=False)
    back = np.rot90(turned.melanin_sd, -1)
    skin = (upright.mask > 0.9) & (np.rot90(turned.mask, -1) > 0.9)
    assert back[skin].mean() == pytest.approx(upright.melanin_sd[skin].mean(), rel=0.05)
    assert np.corrcoef(back[skin], upright.melanin_sd[skin])[0, 1] > 0.8
