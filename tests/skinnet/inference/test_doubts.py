"""A reading that should not be trusted says so in words, with what would help."""

import numpy as np
import pytest

from skinnet import Decomposer
from skinnet.images import read_picture
from skinnet.images.srgb import linear_to_srgb, srgb_to_linear, to_uint8
from skinnet.inference import Capture
from skinnet.inference._doubts import (
    find_tint,
    note_clipping,
    note_dark_skin,
    note_doubts,
    note_little_skin,
)

SURE = (0.2, 0.3)
WHO = "the face in a.jpg"


def test_what_is_known_well_has_no_note() -> None:
    assert note_doubts(WHO, SURE, (0.1, -0.3), False) == ()


@pytest.mark.parametrize(("span", "noted"), [(2.9, False), (3.1, True)])
def test_melanin_is_in_doubt_if_its_interval_spans_a_factor_of_3(span: float, noted: bool) -> None:
    sd = np.log(span) / (2 * 1.644854)
    notes = note_doubts(WHO, (sd, 0.3), (0.0, 0.0), False)
    assert bool(notes) == noted
    if noted:
        assert notes[0].startswith("Melanin cannot be told well from this photograph: that of the")
        assert "may be 1.8 times higher or lower than what is read" in notes[0]
        assert "--white X,Y" in notes[-1] and len(notes) == 2


@pytest.mark.parametrize(("span", "noted"), [(4.9, False), (5.1, True)])
def test_hemoglobin_is_in_doubt_if_its_interval_spans_a_factor_of_5(
    span: float, noted: bool
) -> None:
    sd = np.log(span) / (2 * 1.644854)
    notes = note_doubts(WHO, (0.2, sd), (0.0, 0.0), False)
    assert bool(notes) == noted
    assert not noted or notes[0].startswith("Hemoglobin cannot be told from this photograph")


@pytest.mark.parametrize("balance", [(0.4, 0.0), (0.0, -0.4)])
def test_coloured_light_is_noted_unless_it_is_known(balance: tuple[float, float]) -> None:
    note, remedy = note_doubts(WHO, SURE, balance, False)
    assert note.startswith(f"The light on {WHO} is strongly coloured") and "white" in remedy
    assert note_doubts(WHO, SURE, balance, True) == ()
    assert note_doubts(WHO, SURE, (0.3, -0.3), False) == ()


def test_who_has_given_white_is_not_asked_for_it() -> None:
    notes = note_doubts(WHO, (1.0, 1.0), (0.0, 0.0), True)
    assert len(notes) == 3 and "white" not in notes[-1] and "daylight" in notes[-1]


@pytest.mark.parametrize(("share", "noted"), [(0.05, False), (0.2, True)])
def test_overexposed_skin_is_noted(share: float, noted: bool) -> None:
    photo = np.full((2000, 1500, 3), 200, np.uint8)
    photo[: round(2000 * share), :, 0] = 255
    mask = np.ones((2000, 1500), np.float32)
    notes = note_clipping(WHO, photo, mask)
    assert bool(notes) == noted
    assert not noted or notes[0].startswith(f"20% of the skin of {WHO} is overexposed")
    mask[: round(2000 * share)] = 0
    assert note_clipping(WHO, photo, mask) == note_clipping(WHO, photo, 0 * mask) == ()


@pytest.mark.parametrize(("melanin", "noted"), [(0.05, False), (0.11, False), (0.25, True)])
def test_dark_skin_may_be_darker_than_it_is_read(melanin: float, noted: bool) -> None:
    fractions, mask = np.full((8, 8), melanin, np.float32), np.ones((8, 8), np.float32)
    fractions[:2], mask[:2] = 0.6 - melanin, 0  # the background does not count
    notes = note_dark_skin(WHO, fractions, mask)
    assert bool(notes) == noted
    assert not noted or notes[0].startswith("Dark skin is often read as paler than it is")
    assert not noted or f"the melanin of {WHO} may be above its interval" in notes[0]
    assert note_dark_skin(WHO, fractions, 0 * mask) == ()


def test_notes_are_those_of_the_photograph(decomposer: Decomposer, astronaut: np.ndarray) -> None:
    # The tiny model takes the wall for skin, which is no cast in warm light.
    astronaut = (astronaut * np.array([1, 0.95, 0.85])).astype(np.uint8)
    assert decomposer(astronaut, detail=False).notes == ()
    slightly_warm = Capture(white_balance=(0.1, -0.1))
    assert decomposer(astronaut, detail=False, capture=slightly_warm).notes == ()
    warm = Capture(white_balance=(0.5, -0.5))
    (note,) = decomposer(astronaut, detail=False, capture=warm, name="a.jpg").notes
    assert note.startswith("The white balance that was given for the face in a.jpg is far from")
    assert "0.50, -0.50" in note and note.endswith("and lit as the face is?")
    picture = read_picture(astronaut)
    assert decomposer.edit_picture(picture, 2.0, capture=slightly_warm).notes == ()
    assert decomposer.edit_picture(picture, 2.0, capture=warm, name="a.jpg").notes == (note,)
    burnt = np.where(astronaut > 150, 255, astronaut).astype(np.uint8)
    note, *_ = decomposer(burnt, detail=False, name="b.jpg").notes
    assert "% of the skin of the face in b.jpg is overexposed" in note


@pytest.mark.parametrize(
    ("gains", "tint"),
    [((1.0, 1.0), None), ((1.3, 0.8), None), ((1.6, 0.6), "yellow"), ((0.6, 1.6), "blue")],
)
def test_a_tinted_photograph_is_noted(
    astronaut: np.ndarray, gains: tuple[float, float], tint: str | None
) -> None:
    gain = np.array([gains[0], 1.0, gains[1]], np.float32)
    photo = to_uint8(linear_to_srgb((srgb_to_linear(astronaut) * gain).clip(0, 1)))
    notes = Decomposer(threads=1)(photo, name="a.jpg", detail=False).notes
    words = f"The skin of {WHO} looks tinted {tint}, as by coloured light, a filter or a "
    assert any(note.startswith(words) for note in notes) == (tint is not None)
    assert tint is not None or not any("tinted" in note for note in notes)


@pytest.mark.parametrize(
    ("ratios", "tint"),
    [
        *(((0.75, -0.3), None), ((1.0, -1.0), "orange"), ((0.0, 0.0), "blue")),
        *(((0.1, -1.4), "green"), ((1.1, 1.3), "violet"), ((1.9, 0.0), "red")),
    ],
)
def test_a_cast_has_a_name(ratios: tuple[float, float], tint: str | None) -> None:
    assert find_tint(ratios) == tint


def test_a_tint_is_said_once() -> None:
    notes = note_doubts(WHO, SURE, (0.9, 0.0), False, "green")
    assert len(notes) == 2 and "looks tinted green" in notes[0] and "--white X,Y" in notes[1]


def test_nearly_no_skin_is_noted() -> None:
    mask = np.zeros((100, 100), np.float32)
    assert note_little_skin(WHO, mask)[0].startswith(f"No skin was found of {WHO}; ")
    mask[:2] = 1
    assert note_little_skin(WHO, mask)[0].startswith(
        f"Nearly no skin of {WHO} was found: only 2 % of what was read."
    )
    mask[:20] = 1
    assert note_little_skin(WHO, mask) == ()


def test_a_covered_face_is_noted(astronaut: np.ndarray) -> None:
    rng = np.random.default_rng(0)
    cloth = rng.normal((60, 90, 60), 25, (150, 200, 3)).clip(0, 255)
    astronaut = astronaut.copy()
    astronaut[122:272, 130:330] = cloth
    face = Decomposer(threads=1)(astronaut, name="a.jpg", detail=False)
    assert face.skin_share < 0.1 and face.notes[0].startswith(f"Nearly no skin of {WHO} was found")
    assert face.summary()["notes"][0] == face.notes[0]


def test_a_group_is_noted(astronaut: np.ndarray) -> None:
    group = np.concatenate([astronaut, astronaut[:, ::-1]], 1)
    faces = Decomposer(threads=1)(group, name="a.jpg", detail=False, faces="all")
    note = "a.jpg shows 2 faces, numbered from left to right."
    assert [face.notes for face in faces] == [(note,), (note,)]
    assert [face.summary()["faces_found"] for face in faces] == [2, 2]
