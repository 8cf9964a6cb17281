"""Indices from pigments: what they are, and what their intervals hold."""

import json
import math
from dataclasses import replace

import numpy as np
import pytest

from skinnet import Decomposer, Decomposition
from skinnet.errors import InputError
from skinnet.inference import compute_indices
from skinnet.inference._index_summary import Index
from skinnet.inference._index_table import INDICES, look_up
from skinnet.inference.indices import _find_indices

RNG = np.random.default_rng(0)


def test_more_melanin_is_darker_and_more_blood_is_redder() -> None:
    pale, tanned, flushed = (compute_indices(*f) for f in ((0.03, 0.04), (0.1, 0.04), (0.03, 0.08)))
    assert tanned.l_star.value < pale.l_star.value
    assert tanned.typology_angle.value < pale.typology_angle.value
    assert tanned.melanin_index.value > pale.melanin_index.value
    assert flushed.a_star.value > pale.a_star.value
    assert flushed.erythema_index.value > pale.erythema_index.value
    assert [one.typology_group for one in (pale, tanned)] == ["very_light", "tan"]
    assert pale.monk_tone.value < tanned.monk_tone.value


def test_the_angle_is_that_of_the_colour() -> None:
    found = compute_indices(0.07, 0.05)
    angle = math.degrees(math.atan((found.l_star.value - 50) / found.b_star.value))
    assert found.typology_angle.value == pytest.approx(angle)


@pytest.mark.parametrize("melanin", [0.0, 0.006, 0.02, 0.1, 0.25, 0.43, 1.0])
def test_intervals_hold_the_value_and_grow_with_what_is_not_known(melanin: float) -> None:
    exact, wide = compute_indices(melanin, 0.04), compute_indices(melanin, 0.04, (0.3, 0.2))
    wider = compute_indices(melanin, 0.04, (0.3, 0.2), level=0.99)
    for name in INDICES:
        one, two, three = (getattr(each, name) for each in (exact, wide, wider))
        assert one.value == two.value == three.value
        assert three.interval[0] <= two.interval[0] <= one.interval[0] < one.value
        assert one.value < one.interval[1] <= two.interval[1] <= three.interval[1]
        assert 0 < one.sd <= two.sd == three.sd
    low, high = wide.monk_tone.interval
    assert 1 <= low <= wide.monk_tone.value <= high <= 10


@pytest.mark.parametrize("correlation", [-1.0, -0.5, 0.0, 0.7, 1.0])
@pytest.mark.parametrize(("melanin", "hemoglobin"), [(0.02, 0.03), (0.08, 0.06), (0.25, 0.04)])
def test_intervals_hold_the_truth_whatever_the_correlation_of_errors(
    melanin: float, hemoglobin: float, correlation: float
) -> None:
    log_sds = (0.3, 0.25)
    found = compute_indices(melanin, hemoglobin, log_sds)
    first, second = RNG.standard_normal((2, 4000))
    second = correlation * first + math.sqrt(1 - correlation**2) * second
    true, people = look_up(
        melanin * np.exp(log_sds[0] * first), hemoglobin * np.exp(log_sds[1] * second)
    )
    true = true + people * RNG.standard_normal((4000, 1))
    for name, values in zip(INDICES, true.T, strict=True):
        low, high = getattr(found, name).interval
        assert np.mean((low <= values) & (values <= high)) > 0.86, name


def test_one_standard_deviation_is_that_of_a_linear_model_where_errors_are_small() -> None:
    found, step = compute_indices(0.08, 0.05, (0.05, 0.0)), 0.05
    values, people = look_up(0.08 * np.exp([step, 0, -step]), np.full(3, 0.05))
    expected = np.hypot(0.05 * (values[0] - values[2]) / (2 * step), people[1])
    sds = [getattr(found, name).sd for name in INDICES]
    np.testing.assert_allclose(sds, expected, rtol=0.05)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ((5.0, 0.04), "melanin is a volume fraction in [0, 1]; got 5. Was it given in percent?"),
        ((0.05, math.nan), "hemoglobin is a volume fraction in [0, 1]; got nan."),
        ((0.05, 0.04, (-0.1, 0.1)), "at least 0; got -0.1."),
        ((0.05, 0.04, (0.1, math.inf)), "got inf."),
        ((0.05, 0.04, (0.1, 0.1), 90.0), "between 0 and 1; got 90."),
    ],
)
def test_bad_input_is_refused_in_a_sentence(arguments: tuple, words: str) -> None:
    with pytest.raises(InputError) as error:
        compute_indices(*arguments)
    assert words in str(error.value)


def test_fractions_of_other_presets_have_no_indices(decomposition: Decomposition) -> None:
    assert decomposition.model["optics"] == "paper"
    assert decomposition.indices() is None and decomposition.summary()["indices"] is None
    assert decomposition.regions["nose"].indices is None
    with pytest.raises(InputError, match="between 0 and 1"):
        decomposition.indices(level=2.0)


def test_the_face_and_its_regions_have_indices(decomposition: Decomposition) -> None:
    model = decomposition.model | {"optics": "measured"}
    face = replace(decomposition, model=model)
    found = face.indices()
    means = face.means["melanin"], face.means["hemoglobin"]
    assert found is not None and found == compute_indices(*means, face.uncertainty.face)
    summary = json.loads(json.dumps(face.summary(), allow_nan=False))
    angle = found.typology_angle
    assert summary["indices"]["typology_angle"]["value"] == pytest.approx(angle.value, abs=1e-4)
    assert summary["indices"]["typology_angle"]["interval"] == pytest.approx(angle.interval, 1e-4)
    assert set(summary["indices"]) == {*INDICES, "typology_group", "monk_tone"}
    nose = face.regions["nose"]
    assert nose.indices is not None and nose.melanin.mean is not None
    (alone,), _ = look_up(np.array([nose.melanin.mean]), np.array([nose.hemoglobin.mean]))
    assert [getattr(nose.indices, name).value for name in INDICES] == pytest.approx(alone)
    assert summary["regions"]["nose"]["indices"]["typology_group"] == nose.indices.typology_group
    narrow, wide = (face.indices(level) for level in (0.5, 0.99))
    assert narrow is not None and wide is not None
    assert narrow.l_star.interval[0] > wide.l_star.interval[0]
    assert isinstance(found.l_star, Index)


def test_without_skin_there_are_no_indices(skinless_file, astronaut: np.ndarray) -> None:
    face = Decomposer(skinless_file)(astronaut)
    assert replace(face, model={"optics": "measured"}).indices() is None
    assert _find_indices("measured", (None, None), (0.1, 0.1)) is None
