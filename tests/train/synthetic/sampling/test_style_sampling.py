"""Shares of beards, make-up and colours of cloth."""

import numpy as np
import pytest
import torch

from train.synthetic.painting.style_painting import has_style
from train.synthetic.sampling.face_sampling import sample_face
from train.synthetic.sampling.scene_sampling import sample_person
from train.synthetic.sampling.style_sampling import (
    BEARD_SHARES,
    MAKE_UP_SHARE,
    OWN_SKIN_SHARE,
    SKIN_COLOUR_SHARE,
    STUBBLE_RANGE,
    fit_long_beard,
    vary_surroundings,
)
from train.synthetic.scene import FaceParameters

COUNT = 900


@pytest.fixture(scope="module")
def faces() -> list[FaceParameters]:
    return [sample_face(np.random.default_rng([5, k]), variety="any") for k in range(COUNT)]


def test_shares_of_beards_and_stubble_are_those_that_are_documented(
    faces: list[FaceParameters],
) -> None:
    assert sum(BEARD_SHARES.values()) == pytest.approx(1)
    parts = np.array([one.beard_style.parts.tolist() for one in faces])
    beards = np.array([float(one.beard_style.beard) for one in faces])
    stubble = np.array([float(one.beard_style.stubble) for one in faces])
    whole = parts.sum(1) == 4
    assert whole.mean() == pytest.approx(BEARD_SHARES["full"] + BEARD_SHARES["boxed"], abs=0.03)
    moustaches = (parts == (0, 0, 1, 0)).all(1)
    assert moustaches.mean() == pytest.approx(BEARD_SHARES["moustache"], abs=0.025)
    assert ((beards > 0.7) == (parts.sum(1) > 0)).all()
    alone = (stubble > 0) & (beards == 0)
    assert alone.mean() == pytest.approx(BEARD_SHARES["stubble"], abs=0.03)
    assert stubble.max() <= STUBBLE_RANGE[1] < 0.5
    assert stubble[alone].min() < 0.12 and stubble[alone].max() > 0.36


def test_made_up_faces_have_no_beard(faces: list[FaceParameters]) -> None:
    made_up = np.array(
        [
            bool(one.cosmetics.foundation + one.cosmetics.blush + one.features.make_up > 0)
            for one in faces
        ]
    )
    bare = np.array([float(one.beard_style.beard + one.beard_style.stubble) == 0 for one in faces])
    assert bare[made_up].all()
    # Of those who wear make-up a few have eye shadow or eyeliner alone.
    share = made_up.sum() / bare.sum()
    assert 0.8 * MAKE_UP_SHARE < share < 1.1 * MAKE_UP_SHARE


def test_some_cloth_has_the_colour_of_the_wearers_skin(faces: list[FaceParameters]) -> None:
    own = np.array([one.garments.own_skin.tolist() for one in faces])
    np.testing.assert_allclose(own.mean(0), OWN_SKIN_SHARE, atol=0.03)
    colours = np.array([one.garments.colours.numpy() for one in faces])
    assert 0 < colours.min() and colours.max() <= 0.9


def test_some_clothes_and_walls_have_a_colour_of_skin() -> None:
    rng = np.random.default_rng(6)
    _, before = sample_person(rng, variety="mild")
    changed = np.zeros(3)
    for _ in range(500):
        after = vary_surroundings(before, rng)
        pairs = ((after.jacket, before.jacket), (after.shirt, before.shirt))
        changed += [*(not torch.equal(a, b) for a, b in pairs), after.wall is not before.wall]
        assert 0 < after.jacket.min() and after.wall.mean() < 1.2
    np.testing.assert_allclose(changed / 500, SKIN_COLOUR_SHARE, atol=0.05)


def test_the_same_numbers_give_the_same_style_and_mild_faces_have_none() -> None:
    one, other = (sample_face(np.random.default_rng(8), variety="any") for _ in range(2))
    assert one.garments.colours.equal(other.garments.colours)
    assert one.beard_style.hairs.equal(other.beard_style.hairs)
    mild = sample_face(np.random.default_rng(8))
    assert has_style(one) and not has_style(mild)
    assert mild.skin.bump.equal(one.skin.bump)


def test_a_long_beard_has_a_full_one_around_it(faces: list[FaceParameters]) -> None:
    style = fit_long_beard(faces[0]).beard_style
    assert style.parts.tolist() == [1, 1, 1, 1] and float(style.beard) > 0.89
