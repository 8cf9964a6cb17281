"""Edits of pigments are weighed by a mask, clipped, and give the colours of skin."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from benchmarks.appearance import make_person
from benchmarks.edits import compute_excess, compute_lab, edit_skins, invert_colours, load_colours
from benchmarks.edits import make_colour as make_d65_colour
from skinnet.appearance import PigmentEdit, SkinColour, SkinTexture, edit_texture
from skinnet.errors import InputError


@cache
def measured_skins() -> tuple[SkinTexture, SkinColour, np.ndarray]:
    """Measured skins as a texture, their light, and their colours in L*, a* and b*."""
    colours, colour = load_colours(), make_d65_colour("measured")
    return invert_colours(colours, colour), colour, compute_lab(colours)


def test_a_mask_weighs_the_edit(colour: SkinColour) -> None:
    face = make_person(20, 0)
    mask = np.full((20, 20), 0.25)
    edited = edit_texture(
        face, colour, PigmentEdit(paint=0.2), PigmentEdit(scale=2.0, add=0.01), mask
    )
    assert np.allclose(edited.f_mel, 0.75 * face.f_mel + 0.05)
    assert np.allclose(edited.f_blood, face.f_blood + 0.25 * (face.f_blood + 0.01), atol=1e-6)


def test_texels_that_keep_their_fractions_keep_every_bit(colour: SkinColour) -> None:
    face, mask = make_person(20, 0), np.zeros((20, 20))
    mask[:10] = 0.3
    same = edit_texture(face, colour, PigmentEdit(), PigmentEdit(), np.full((20, 20), 0.3))
    half = edit_texture(face, colour, PigmentEdit(scale=2.0), PigmentEdit(), mask)
    for name in ("f_mel", "f_blood", "offset"):
        assert np.array_equal(getattr(same, name), getattr(face, name))
        assert np.array_equal(getattr(half, name)[10:], getattr(face, name)[10:])
    assert np.array_equal(same.albedo(colour), face.albedo(colour))


def test_the_offset_darkens_with_the_skin_and_never_grows(colour: SkinColour) -> None:
    face = make_person(20, 0)
    darker = edit_texture(face, colour, PigmentEdit(scale=3.0), PigmentEdit())
    paler = edit_texture(face, colour, PigmentEdit(scale=0.5), PigmentEdit())
    assert np.array_equal(paler.offset, face.offset)
    before, after = (
        replace(one, offset=np.zeros_like(one.offset)).albedo(colour)[face.mask]
        for one in (face, darker)
    )
    expected = face.offset[face.mask] * after / before
    assert np.allclose(darker.offset[face.mask], expected, atol=1e-7)


@pytest.mark.parametrize(
    ("edit", "inside", "near"),
    [
        ({"melanin": 0.7}, 0.85, 0.95),
        ({"melanin": 1.5}, 0.82, 0.95),
        ({"melanin": 2.0}, 0.78, 0.95),
        ({"melanin": 0.5}, 0.80, 0.90),
        ({"melanin": 0.4}, 0.75, 0.88),
        ({"melanin": 4.0}, 0.55, 0.80),
        ({"blood": 0.5}, 0.88, 0.97),
        ({"blood": 2.0}, 0.88, 0.97),
        ({"blood": 0.25}, 0.70, 0.90),
        ({"blood": 4.0}, 0.75, 0.87),
    ],
)
def test_edited_measured_skins_are_skin(edit: dict[str, float], inside: float, near: float) -> None:
    """Few skins are as dark as melanin x 4 makes them, so their hull is small."""
    skins, colour, measured = measured_skins()
    edited = edit_skins(skins, colour, **edit)
    excess = compute_excess(compute_lab(edited.colours), measured)
    known = excess[edited.possible & ~np.isnan(excess)]
    assert len(known) > 150
    assert np.mean(known <= 0) > inside
    assert np.mean(known <= 1) > near


def test_dark_skin_with_half_its_melanin_is_not_blue() -> None:
    skins, colour, measured = measured_skins()
    lab = compute_lab(edit_skins(skins, colour, melanin=0.5).colours)
    dark = measured[:, 0] < 40
    same_lightness = np.abs(measured[:, 0] - lab[dark, 0].mean()) < 5
    assert lab[dark, 2].min() > measured[same_lightness, 2].min() - 1
    assert abs(np.median(lab[dark, 2]) - np.median(measured[same_lightness, 2])) < 3


def test_fractions_stay_in_the_unit_interval() -> None:
    fraction = np.array([0.0, 0.5, 1.0], np.float32)
    assert PigmentEdit(scale=3.0, add=-0.1)(fraction).tolist() == [0, 1, 1]


def test_a_mask_of_another_size_is_refused(colour: SkinColour) -> None:
    with pytest.raises(InputError, match="mask is 8 x 8 and the maps of person 0 are 20 x 20"):
        edit_texture(make_person(20, 0), colour, PigmentEdit(), PigmentEdit(), np.ones((8, 8)))


@pytest.mark.parametrize(
    ("values", "sentence"),
    [
        ({"scale": -1.0}, "scale is a factor from 0 to 10; got -1.0"),
        ({"add": 20.0}, "add is a volume fraction .* got 20.0. Was it given in percent"),
        ({"paint": 5.0}, "paint is a volume fraction .* got 5.0. Was it given in percent"),
    ],
)
def test_values_outside_their_range_are_refused(values: dict[str, float], sentence: str) -> None:
    with pytest.raises(InputError, match=sentence):
        PigmentEdit(**values)
