"""Shots of one session are found by their colour, and one outlying shot by Cochran's Q."""

import numpy as np
import pytest

from skinnet.errors import InputError
from skinnet.inference._agreement import (
    describe_outlier,
    find_outlier,
    find_sessions,
    fuse_shots,
    note_disagreement,
    note_sessions,
)
from skinnet.inference._person_shot import PersonShot


def make_shot(
    melanin: float, hemoglobin: float = 0.06, sd: float = 0.15, red: float = 0.0, name: str = ""
) -> PersonShot:
    """A shot of which only the whole skin is known; `red` is its log R/G."""
    return PersonShot(
        name or f"{melanin:g}.jpg",
        np.log([[melanin, hemoglobin]]),
        np.full((1, 2), sd),
        np.array([red, 0.0]),
        (0.43, 0.15),
        False,
        {"version": "1", "optics": "measured"},
    )


def make_shots(*melanin: float) -> list[PersonShot]:
    """Shots in light of other colours."""
    return [make_shot(each, red=0.2 * number) for number, each in enumerate(melanin)]


def test_shots_of_one_colour_share_a_session() -> None:
    colours = np.array([[0.4, -0.3], [0.0, 0.0], [0.46, -0.3], [0.4, -0.22], [np.nan, np.nan]])
    assert find_sessions(colours).tolist() == [0, 1, 0, 0, 2]


@pytest.mark.parametrize("melanin", [(0.05, 0.055), (0.05, 0.06, 0.045), (0.05,) * 6])
def test_shots_that_agree_are_all_used(melanin: tuple[float, ...]) -> None:
    shots = make_shots(*melanin)
    assert find_outlier(shots) is None
    assert note_disagreement(*fuse_shots(shots)) == []


@pytest.mark.parametrize("index", [0, 1, 3])
def test_one_shot_that_is_plainly_unlike_the_others_is_left_out(index: int) -> None:
    melanin = [0.05, 0.055, 0.048, 0.052]
    melanin[index] = 0.2
    shots = make_shots(*melanin)
    assert find_outlier(shots) == index
    said = describe_outlier(shots, index)
    assert said.startswith("0.2.jpg was left out: its melanin, 0.2, is plainly not the 0.05")
    assert said.endswith("the other 3 shots, which agree. It has failed, or shows another person.")


def test_hemoglobin_tells_a_failed_shot_too() -> None:
    shots = [make_shot(0.05, red=0.2 * at) for at in range(3)] + [make_shot(0.05, 0.012, red=1)]
    assert find_outlier(shots) == 3
    assert "its hemoglobin, 0.012, is plainly not the 0.06" in describe_outlier(shots, 3)


@pytest.mark.parametrize(
    "melanin", [(0.05, 0.25), (0.05, 0.055, 0.2, 0.21), (0.02, 0.1, 0.4), (0.05, 0.05, 0.01, 0.3)]
)
def test_several_people_are_refused_with_the_values(melanin: tuple[float, ...]) -> None:
    with pytest.raises(InputError, match=r"plainly not of one skin: melanin is 0\.") as caught:
        find_outlier(make_shots(*melanin))
    said = str(caught.value)
    assert f"{min(melanin):g} in {min(melanin):g}.jpg and {max(melanin):g} in" in said
    assert "degree" in said and "Give shots of one person" in said


def test_two_people_of_one_session_are_refused() -> None:
    with pytest.raises(InputError, match="plainly not of one skin"):
        find_outlier([make_shot(0.05), make_shot(0.25)])


def test_shots_that_differ_more_than_they_state_are_noted_and_widen() -> None:
    shots = make_shots(0.04, 0.06, 0.075, 0.05)
    assert find_outlier(shots) is None
    (said,) = note_disagreement(*fuse_shots(shots))
    melanin = fuse_shots(shots)[0]
    assert melanin.birge_ratio[0] > 1.5
    assert said.startswith("The shots differ in melanin more than they state (Q ")
    assert f"{melanin.birge_ratio[0]:.2g} times as wide" in said


def test_a_session_against_one_other_shot_is_refused_and_a_failure_within_it_is_left_out() -> None:
    session = [make_shot(0.05), make_shot(0.051), make_shot(0.052)]
    with pytest.raises(InputError, match="plainly not of one skin"):
        find_outlier([*session, make_shot(0.25, red=0.5)])
    assert find_outlier([*session, make_shot(0.25)]) == 3


def test_unsure_shots_are_not_unlike_others() -> None:
    shots = [*make_shots(0.05, 0.052, 0.05), make_shot(0.2, sd=0.9, red=1)]
    assert find_outlier(shots) is None
    assert np.exp(fuse_shots(shots)[0].value[0]) == pytest.approx(0.051, rel=0.05)


def test_sessions_are_noted_by_their_names() -> None:
    shots = [*make_shots(0.05, 0.06), make_shot(0.052, name="c.jpg")]
    (said,) = note_sessions(shots)
    assert said.startswith(
        "The skin has one colour in 0.05.jpg and c.jpg: they are taken for shots"
    )
