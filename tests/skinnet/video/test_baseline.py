"""Colours of frames beside those of a baseline."""

import numpy as np

from skinnet.video._baseline import Baseline

SKIN = np.array([0.5, 0.3, 0.2], np.float32)
TEXELS = 100


def make_baseline(frames: list[np.ndarray] | None = None) -> Baseline:
    """The whole face, and a region of its first half."""
    regions = np.ones((2, TEXELS), bool)
    regions[1, TEXELS // 2 :] = False
    whole = [np.tile(SKIN, (TEXELS, 1))] if frames is None else frames
    return Baseline(whole, np.ones(TEXELS, bool), regions)


def test_ratios_are_those_of_linear_light() -> None:
    compared = make_baseline().compare(np.tile(SKIN * np.float32([1.1, 1.0, 0.9]), (TEXELS, 1)))
    np.testing.assert_allclose(compared.ratios, [np.log([1.1, 1.0, 0.9])] * 2, atol=1e-5)
    assert compared.seen.all()


def test_frames_of_a_baseline_may_differ_in_exposure() -> None:
    whole = np.tile(SKIN, (TEXELS, 1))
    np.testing.assert_allclose(make_baseline([0.5 * whole, whole]).colours, 0.75 * whole, rtol=1e-5)


def test_a_region_is_hidden_where_too_little_of_it_is_seen() -> None:
    frame = np.tile(SKIN, (TEXELS, 1))
    frame[:35] = np.nan  # seven of ten texels of the region
    compared = make_baseline().compare(frame)
    assert np.isfinite(compared.ratios[0]).all() and np.isnan(compared.ratios[1]).all()


def test_what_stands_before_the_skin_is_not_seen() -> None:
    frame = np.tile(SKIN, (TEXELS, 1))
    frame[:20] = [0.05, 0.2, 0.6]  # a blue pen
    compared = make_baseline().compare(frame)
    assert not compared.seen[:20].any() and compared.seen[20:].all()
    np.testing.assert_allclose(compared.ratios, 0, atol=1e-6)


def test_black_and_burnt_out_texels_are_not_usable() -> None:
    whole = np.tile(SKIN, (TEXELS, 1))
    whole[0], whole[1] = 1.0, 0.0
    assert make_baseline([whole]).usable.tolist() == [False, False] + [True] * (TEXELS - 2)
