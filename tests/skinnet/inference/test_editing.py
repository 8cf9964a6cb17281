from typing import Any

import numpy as np
from numpy.typing import NDArray

from skinnet.images import Box, linear_to_srgb, read_picture, srgb_to_linear, to_uint8
from skinnet.inference._editing import ColourChange, apply_change, compute_change, fade_edges


def test_nothing_changes_where_colours_stay() -> None:
    colours = np.random.default_rng(0).random((6, 5, 3), np.float32)
    colours[0] = 0
    change = compute_change(colours, colours, np.zeros((6, 5), np.float32))
    assert (change.loss == 0).all() and (change.gain == 0).all()


def test_skin_of_the_colour_of_the_model_gets_the_new_colour() -> None:
    before, after = np.float32([0.3, 0.15, 0.06]), np.float32([0.2, 0.08, 0.02])
    for old, new in ((before, after), (after, before)):
        edited = edit_flat(0.5 * old, old, new)
        np.testing.assert_allclose(edited, 0.5 * new, atol=0.003)


def test_an_unexplained_colour_never_grows() -> None:
    dark, pale = np.float32([0.1, 0.035, 0.008]), np.float32([0.4, 0.25, 0.15])
    unexplained = np.float32([-0.01, 0.0, 0.012])
    lighter = edit_flat(dark + unexplained, dark, pale)
    total = (dark + unexplained).sum() / dark.sum()
    np.testing.assert_allclose(lighter, dark + unexplained + total * (pale - dark), atol=0.004)
    darker = edit_flat(pale + unexplained, pale, dark)
    np.testing.assert_allclose(darker, (pale + unexplained) * dark / pale, atol=0.004)


def edit_flat(
    photo: NDArray[np.float32], before: NDArray[np.float32], after: NDArray[np.float32]
) -> NDArray[np.float32]:
    """Linear sRGB of an edited picture of one colour."""
    ones = np.ones((4, 4), np.float32)
    change = compute_change(ones[..., None] * before, ones[..., None] * after, ones)
    crop = np.full((8, 8, 3), to_uint8(linear_to_srgb(photo)))
    return srgb_to_linear(edit_pixels(crop, change, 0 * ones, ones))[4, 4]


def edit_pixels(crop: NDArray[np.uint8], change: ColourChange, *maps: NDArray[np.float32]) -> Any:
    picture = read_picture(crop)
    apply_change(picture, change, *maps)
    return picture.pixels


def test_specular_reflection_is_not_tinted() -> None:
    crop = np.full((8, 8, 3), 200, np.uint8)
    ones = np.ones((4, 4), np.float32)
    change = compute_change(ones[..., None] * np.ones(3, "f4"), np.full((4, 4, 3), 0.5, "f4"), ones)
    np.testing.assert_array_equal(edit_pixels(crop, change, ones, ones), crop)
    assert (edit_pixels(crop, change, 0 * ones, ones) < 150).all()


def test_edits_fade_towards_edges_inside_the_photograph() -> None:
    fade = fade_edges((50, 50), Box(0, 10, 60, 70), (100, 60))
    assert fade[25, 0] == fade[25, -1] == 1
    assert fade[0, 25] < 0.2 and fade[-1, 25] < 0.2
