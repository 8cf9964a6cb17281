"""The edit of a reading is, in every pixel, that of the photograph."""

import pickle
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

from skinnet import Decomposer, Decomposition
from skinnet.errors import InputError
from skinnet.images import read_picture
from skinnet.inference import Capture, CaptureProfile
from skinnet.inference._references.tone_curve import ToneCurve


@pytest.mark.parametrize("factors", [(2.0, 1.0), (1.0, 3.0), (0.3, 0.5), (1.0, 1.0), (0.0, 10.0)])
def test_it_is_the_edit_of_the_photograph(
    decomposer: Decomposer, astronaut: np.ndarray, factors: tuple[float, float]
) -> None:
    expected = decomposer.edit(astronaut, *factors)
    for detail in (True, False):
        read = decomposer(astronaut, detail=detail)
        np.testing.assert_array_equal(read.edit(*factors), expected)


def test_each_face_is_edited_alone(decomposer: Decomposer, astronaut: np.ndarray) -> None:
    scene = np.concatenate([astronaut[:256, 96:352], astronaut[:256, 351:95:-1]], 1)
    left, right = decomposer(scene, faces="all")
    both = decomposer.edit(scene, 3.0, faces="all")
    for read, own in ((left, slice(0, 200)), (right, slice(312, 512))):
        edited = read.edit(3.0)
        np.testing.assert_array_equal(edited[:, own], both[:, own])
        assert (edited != scene).any()
    assert not (left.edit(3.0)[:, 312:] != scene[:, 312:]).any()


@pytest.mark.parametrize("angle", [20, 70, 180])
def test_tilted_heads_are_edited_alike(
    decomposer: Decomposer, astronaut: np.ndarray, angle: int
) -> None:
    turned = np.asarray(Image.fromarray(astronaut).rotate(angle, fillcolor=(90, 120, 150)))
    read, expected = decomposer(turned), decomposer.edit(turned, 3.0)
    assert (expected != turned).any()
    np.testing.assert_array_equal(read.edit(3.0), expected)


def test_a_mask_limits_it(decomposition: Decomposition, astronaut: np.ndarray) -> None:
    mask = np.zeros(astronaut.shape[:2], bool)
    mask[:, :230] = True
    edited = decomposition.edit(3.0, mask=mask)
    np.testing.assert_array_equal(edited[:, 230:], astronaut[:, 230:])
    np.testing.assert_array_equal(edited[:, :230], decomposition.edit(3.0)[:, :230])
    with pytest.raises(InputError, match="give a mask of the photograph's size"):
        decomposition.edit(3.0, mask=mask[:9])


def test_a_changed_array_does_not_change_it(decomposer: Decomposer, astronaut: np.ndarray) -> None:
    given = astronaut.copy()
    read = decomposer(given)
    given[:] = 0
    np.testing.assert_array_equal(read.edit(2.0), decomposer.edit(astronaut, 2.0))


def test_readings_and_decomposers_travel_to_other_processes(
    decomposition: Decomposition, decomposer: Decomposer, astronaut: np.ndarray
) -> None:
    copy = pickle.loads(pickle.dumps(decomposition))
    assert copy.to_dict() == decomposition.to_dict()
    np.testing.assert_array_equal(copy.edit(2.0), decomposition.edit(2.0))
    again = pickle.loads(pickle.dumps(decomposer))
    assert again.threads == 1 and again(astronaut).means == decomposition.means


def test_factors_are_checked(decomposition: Decomposition) -> None:
    for wrong in (-1.0, 11.0, float("nan")):
        with pytest.raises(InputError, match=r"melanin is multiplied by a number in \[0, 10\]"):
            decomposition.edit(wrong)


def test_without_a_photograph_it_says_so(decomposition: Decomposition) -> None:
    alone: Any = replace(decomposition, _source=None)
    for refused in (lambda: alone.edit(2.0), alone.plot, lambda: alone.save("a.npz")):
        with pytest.raises(InputError, match="since no Decomposer has made it"):
            refused()
    assert "reconstruction, map of melanin" in alone._repr_html_()


def test_what_is_known_of_the_capture_counts_alike(
    decomposer: Decomposer, astronaut: np.ndarray
) -> None:
    white = CaptureProfile.from_white(astronaut, (300, 20, 320, 40))
    read = decomposer(astronaut, capture=white)
    expected = decomposer.edit(astronaut, 2.0, capture=white)
    np.testing.assert_array_equal(read.edit(2.0), expected)


def test_a_profile_with_a_tone_curve_sends_to_the_decomposer(
    decomposer: Decomposer, astronaut: np.ndarray, tmp_path: Path
) -> None:
    known = Capture(white_balance=(0.01, -0.02))
    curve = CaptureProfile(
        known,
        known._replace(linear=True, exposure=-0.3),
        ToneCurve(0.1, 0.4, 0.01, 0.05),
        ((1.0, 0.1, 0.0), (0.0, 1.2, 0.1), (0.0, 0.0, 1.3)),
    )
    read = decomposer(astronaut, capture=curve)
    read.save(tmp_path / "a.npz")
    for each in (read, Decomposition.load(tmp_path / "a.npz", decomposer=decomposer)):
        with pytest.raises(InputError, match=r"use Decomposer\.edit with the photograph and the"):
            each.edit(2.0)
        source = each._source
        assert source is not None
        np.testing.assert_array_equal(source.picture.srgb, astronaut)
        np.testing.assert_array_equal(each.reconstruction, read.reconstruction)


def test_the_photograph_is_not_copied_for_it(decomposer: Decomposer, astronaut: np.ndarray) -> None:
    picture = read_picture(astronaut)
    source = decomposer(picture)._source
    assert source is not None and source.outputs is not None
    assert source.picture.pixels is picture.pixels
    assert sum(each.nbytes for each in source.outputs.values()) < 600_000
