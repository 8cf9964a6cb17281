"""The ten tones of the Monk Skin Tone Scale, and the nearest one, against colour-science."""

import colour
import numpy as np

from skinnet.inference._skin_tones import compare_with_monk, load_monk_tones

PUBLISHED = (
    *((246, 237, 228), (243, 231, 219), (247, 234, 208), (234, 218, 186), (215, 189, 150)),
    *((160, 126, 86), (130, 92, 67), (96, 65, 52), (58, 49, 42), (41, 36, 32)),
)
"""sRGB of https://skintone.google/get-started."""


def test_tones_are_the_published_ones() -> None:
    xyz = colour.sRGB_to_XYZ(np.array(PUBLISHED) / 255)
    white = colour.CCS_ILLUMINANTS["CIE 1931 2 Degree Standard Observer"]["D65"]
    np.testing.assert_allclose(load_monk_tones(), colour.XYZ_to_Lab(xyz, white), atol=0.02)


def test_differences_are_those_of_colour_science() -> None:
    skins = np.random.default_rng(0).uniform((20, 0, 2), (80, 18, 25), (30, 3))
    found = compare_with_monk(skins)
    assert found.shape == (30, 10)
    for skin, row in zip(skins, found, strict=True):
        expected = colour.delta_E(skin, load_monk_tones(), method="CIE 2000")
        np.testing.assert_allclose(row, expected, atol=1e-6)


def test_each_tone_is_nearest_to_itself() -> None:
    assert compare_with_monk(load_monk_tones()).argmin(-1).tolist() == list(range(10))
