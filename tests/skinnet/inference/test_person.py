"""The astronaut in several shots is one person, with an interval that is stated honestly."""

import json
from dataclasses import replace

import numpy as np
import pytest

from skinnet import Decomposer, Decomposition
from skinnet.errors import InputError
from skinnet.images import linear_to_srgb, srgb_to_linear
from skinnet.inference import Person

WHITE_BALANCES = {"plain": (1, 1, 1), "warm": (1.15, 1, 0.85), "cool": (0.87, 1, 1.15)}


def cast(photo: np.ndarray, channels: tuple[float, ...]) -> np.ndarray:
    """A photograph with linear channels multiplied."""
    return np.rint(255 * linear_to_srgb((srgb_to_linear(photo) * channels).clip(0, 1))).astype("u1")


@pytest.fixture(scope="module")
def shipped() -> Decomposer:
    return Decomposer(threads=1)


@pytest.fixture(scope="module")
def shots(shipped: Decomposer, astronaut: np.ndarray) -> dict[str, Decomposition]:
    photos = {name: cast(astronaut, channels) for name, channels in WHITE_BALANCES.items()}
    photos |= {"mirrored": astronaut[:, ::-1], "dark": cast(astronaut, (0.5, 0.5, 0.5))}
    return {name: shipped(photo, detail=False) for name, photo in photos.items()}


@pytest.fixture(scope="module")
def person(shots: dict[str, Decomposition]) -> Person:
    return Person.from_shots(shots.values(), shots)


def scale(shot: Decomposition, factor: float) -> Decomposition:
    """The shot with melanin multiplied."""
    return replace(shot, melanin=shot.melanin * np.float32(factor))


def test_shots_of_one_person_agree(person: Person, shots: dict[str, Decomposition]) -> None:
    assert person.shots == tuple(shots) and None not in person.sessions
    for name, fused in person.pigments.items():
        alone = [shot.means[name] for shot in shots.values()]
        assert min(alone) <= fused.mean <= max(alone)
        assert fused.shots == 5 and fused.agreement.degrees_of_freedom == 4
        assert fused.agreement.p > 0.05 and fused.agreement.birge_ratio == 1


def test_mirrored_and_dark_shots_are_of_the_session_and_other_white_balances_are_not(
    person: Person,
) -> None:
    plain, warm, cool, mirrored, dark = person.sessions
    assert plain == mirrored == dark and len({plain, warm, cool}) == 3
    (said,) = person.notes
    assert "one colour in plain, mirrored and dark: they are taken for shots of one session" in said


def test_light_of_another_colour_narrows_and_shots_of_one_session_do_not(
    shots: dict[str, Decomposition],
) -> None:
    plain = shots["plain"].uncertainty.face
    for count in (2, 6):
        again = Person.from_shots([shots["plain"]] * count)
        for fused, log_sd in zip(again.pigments.values(), plain, strict=True):
            assert fused.sd == pytest.approx(fused.mean * log_sd, rel=1e-4)
    other = Person.from_shots([shots["plain"], shots["warm"]])
    assert other.pigments["melanin"].sd < 0.95 * again.pigments["melanin"].sd


def test_regions_are_fused_of_the_shots_that_show_them(
    person: Person, shots: dict[str, Decomposition]
) -> None:
    assert set(person.regions) == set(shots["plain"].regions)
    for name, region in person.regions.items():
        shown = [shot.regions[name] for shot in shots.values()]
        for pigment in ("melanin", "hemoglobin"):
            means = [getattr(each, pigment).mean for each in shown]
            fused = getattr(region, pigment)
            means = [mean for mean in means if mean is not None]
            assert fused.shots == len(means) > 0
            assert min(means) <= fused.mean <= max(means)
            assert fused.interval[0] < fused.mean < fused.interval[1]


def test_hidden_regions_are_none(shots: dict[str, Decomposition]) -> None:
    def hide(shot: Decomposition) -> Decomposition:
        mask = np.where(shot.region_mask("nose"), np.float32(0), shot.mask)
        return replace(shot, mask=mask)

    one = Person.from_shots([hide(shots["plain"]), shots["warm"]])
    assert one.regions["nose"].melanin.shots == 1 and one.regions["chin"].melanin.shots == 2
    none = Person.from_shots([hide(shots["plain"]), hide(shots["warm"])])
    assert none.regions["nose"].melanin.mean is None and none.regions["nose"].melanin.shots == 0


def test_skin_without_a_face_has_no_regions(shipped: Decomposer, astronaut: np.ndarray) -> None:
    cheek = astronaut[120:160, 230:256]
    shots = [shipped(each, detail=False, region="skin") for each in (cheek, cheek[:, ::-1])]
    person = Person.from_shots(shots)
    assert person.regions == {} and person.means["melanin"] > 0
    assert "2 shots of 1 session" in repr(person)


def test_a_failed_shot_is_left_out(shots: dict[str, Decomposition]) -> None:
    failed = scale(shots["cool"], 6)
    person = Person.from_shots([shots["plain"], failed, shots["warm"]], ["a", "b", "c"])
    assert person.sessions[1] is None and person.pigments["melanin"].shots == 2
    said = f"b was left out: its melanin, {failed.means['melanin']:.2g}, is plainly not the "
    assert person.notes[0].startswith(said + f"{person.means['melanin']:.2g} of the other 2 shots")
    both = Person.from_shots([shots["plain"], shots["warm"]])
    assert person.pigments == both.pigments and person.regions == both.regions
    assert person.summary()["shots"][1]["session"] is None


def test_two_people_are_refused(shots: dict[str, Decomposition]) -> None:
    pair = shots["plain"], scale(shots["plain"], 6)
    one, other = (f"{each.means['melanin']:.2g}" for each in pair)
    with pytest.raises(InputError, match=rf"melanin is {one} in a\.jpg and {other} in b\.jpg"):
        Person.from_shots(pair, ["a.jpg", "b.jpg"])


def test_what_cannot_be_fused_is_refused(shots: dict[str, Decomposition]) -> None:
    plain = shots["plain"]
    blind = replace(plain, mask=np.zeros_like(plain.mask))
    with pytest.raises(InputError, match="from two shots or more; got 1 with skin"):
        Person.from_shots([plain, blind])
    with pytest.raises(InputError, match="got none with skin"):
        Person.from_shots([])
    with pytest.raises(InputError, match="There are 2 shots and 1 names"):
        Person.from_shots([plain, plain], ["a.jpg"])
    other = replace(plain, model={**plain.model, "optics": "paper"})
    with pytest.raises(InputError, match="read with 2 models"):
        Person.from_shots([plain, other])
    without = Person.from_shots([plain, blind, shots["warm"]])
    assert without.sessions[1] is None
    assert without.notes[0] == "shot 2 was left out: no skin was found."


def test_intervals_are_those_of_the_level(person: Person) -> None:
    for name, fused in person.pigments.items():
        assert person.interval()[name] == pytest.approx(fused.interval, rel=1e-4)
        low, high = person.interval(0.5)[name]
        assert fused.interval[0] < low < fused.mean < high < fused.interval[1]
    with pytest.raises(InputError, match="probability between 0 and 1"):
        person.interval(2.0)


def test_indices_are_those_of_the_fused_pigments(
    person: Person, shots: dict[str, Decomposition]
) -> None:
    angles = [shot.indices().typology_angle for shot in shots.values()]
    fused = person.indices().typology_angle
    assert min(one.value for one in angles) <= fused.value <= max(one.value for one in angles)
    assert fused.sd < max(one.sd for one in angles)
    assert person.summary()["indices"]["typology_angle"]["value"] == round(fused.value, 4)
    nose = person.summary()["regions"]["nose"]["indices"]
    assert nose["monk_tone"]["value"] == person.regions["nose"].indices.monk_tone.value
    with pytest.raises(InputError, match="probability between 0 and 1"):
        person.indices(0.0)


def test_the_summary_is_json(person: Person) -> None:
    summary = json.loads(json.dumps(person.summary(), allow_nan=False))
    assert [shot["name"] for shot in summary["shots"]] == list(person.shots)
    for name, pigment in summary["pigments"].items():
        assert pigment["mean"] == person.means[name] and pigment["level"] == 0.9
        assert set(pigment["agreement"]) == {"q", "degrees_of_freedom", "p", "birge_ratio"}
    assert set(summary["regions"]["nose"]["melanin"]) == set(summary["pigments"]["melanin"])
    assert summary["shared_correlation"].keys() == summary["pigments"].keys()
