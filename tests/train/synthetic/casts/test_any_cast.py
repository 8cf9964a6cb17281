"""Casts of the variety `any`: every pixel knows whose skin it shows."""

from collections.abc import Callable

import numpy as np
import pytest

from train.synthetic.bodies.labelled_mesh import LabelledMesh
from train.synthetic.casts import any_cast
from train.synthetic.casts.head_cast import HeadCast
from train.synthetic.labels import BACKGROUND, BODY, EYE, MATERIALS, MOUTH, SKIN, TEETH
from train.synthetic.subjects.heads import make_procedural_head

SIZE = 48

Cast = Callable[[str, int], HeadCast]


def make_head(rng: np.random.Generator) -> LabelledMesh:
    return make_procedural_head(rng, "any")


@pytest.fixture
def cast(monkeypatch: pytest.MonkeyPatch) -> Cast:
    """Casts a picture of a kind."""

    def make(kind: str, seed: int) -> HeadCast:
        monkeypatch.setattr(any_cast, "sample_kind", lambda rng: kind)
        return any_cast.cast_any(make_head, np.random.default_rng(seed), SIZE)

    return make


def test_casts_repeat_and_have_the_types_of_mild_ones(cast: Cast) -> None:
    one, other = cast("face", 3), cast("face", 3)
    for a, b in zip(one, other, strict=True):
        np.testing.assert_array_equal(a, b)
    assert [str(a.dtype) for a in one] == ["uint8", "int8", "float16", "uint8", "uint64"]


@pytest.mark.parametrize("seed", range(3))
def test_a_face_is_of_one_person(cast: Cast, seed: int) -> None:
    label = cast("face", seed).label
    assert set(np.unique(label // MATERIALS)) <= {0, BODY}
    assert (label == SKIN).any()


def test_a_group_is_of_several_people(cast: Cast) -> None:
    people = [
        set(np.unique(cast("group", seed).label // MATERIALS % BODY).tolist()) for seed in range(3)
    ]
    assert all(one <= {0, 1, 2, 3} for one in people)
    assert all(len(one) >= 2 for one in people)


@pytest.mark.parametrize("seed", range(6))
def test_pictures_of_skin_have_skin_and_no_face(cast: Cast, seed: int) -> None:
    label = cast("skin", seed).label
    material = label % MATERIALS
    assert (material == SKIN).mean() > 0.05
    assert not np.isin(material, (EYE, TEETH, MOUTH)).any()
    # One painting colours the wall too.
    assert len(np.unique(label // MATERIALS)) == 1 or (label < BODY * MATERIALS).any()


def test_the_wall_is_of_the_first_person(cast: Cast) -> None:
    label = cast("group", 1).label
    away = label % MATERIALS == BACKGROUND
    assert away.any() and (label[away] == 0).all()
