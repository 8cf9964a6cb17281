"""Pictures of the variety `any` have the poses and sizes that they should have."""

import numpy as np
import pytest

from train.synthetic.subjects.framing import (
    HEIGHTS,
    KINDS,
    MAX_ANGLES,
    Framing,
    make_view,
    rotate,
    sample_framing,
    sample_kind,
)


@pytest.fixture(scope="module")
def framings() -> list[Framing]:
    return [sample_framing(np.random.default_rng([5, index])) for index in range(600)]


def test_all_poses_are_reached_and_none_is_exceeded(framings: list[Framing]) -> None:
    angles = np.abs([one.angles for one in framings])
    assert (angles <= MAX_ANGLES).all()
    assert (angles.max(0)[1:] > 0.97 * MAX_ANGLES[1:]).all() and angles[:, 0].max() > 0.4
    np.testing.assert_allclose(MAX_ANGLES, np.radians((30, 60, 45)))
    # Half of all faces are turned by more than 20 degrees, a third are tilted by more than 15.
    assert (angles[:, 1] > np.radians(20)).mean() > 0.45
    assert (angles[:, 2] > np.radians(15)).mean() > 0.3


def test_heads_are_small_usual_and_frame_filling(framings: list[Framing]) -> None:
    zoom = np.array([one.zoom for one in framings])
    assert zoom.min() < 0.14 and zoom.max() > 1.6
    share = np.histogram(zoom, HEIGHTS)[0] / len(zoom)
    np.testing.assert_allclose(share, (0.2, 0.5, 0.3), atol=0.06)


def test_heads_lie_off_centre_and_across_the_edge(framings: list[Framing]) -> None:
    top = np.array([one.centre[1] + one.zoom for one in framings])
    side = np.array([abs(one.centre[0]) + 0.7 * one.zoom for one in framings])
    assert 0.2 < ((top > 1) | (side > 1)).mean() < 0.7
    assert np.abs([one.centre for one in framings]).max() < 1


def test_kinds_have_their_shares() -> None:
    kinds = [sample_kind(np.random.default_rng([1, index])) for index in range(1000)]
    for kind, share in KINDS.items():
        assert kinds.count(kind) / 1000 == pytest.approx(share, abs=0.04)
    assert sum(KINDS.values()) == pytest.approx(1)


@pytest.mark.parametrize("orthographic", [True, False])
def test_a_point_lies_where_its_framing_says(orthographic: bool) -> None:
    angles, centre = np.array([0.2, -0.5, 0.3]), np.array([0.4, -0.2])
    point = np.array([0.3, 1.0, -0.4])
    view = make_view(Framing(angles, 0.5, centre, 9.0, orthographic), point, 100)
    np.testing.assert_allclose(view.project(point[None]), [[70, 60]], atol=1e-9)
    # A head is two half heads high.
    above = point + rotate(angles)[1]
    assert np.linalg.norm(view.project(above[None]) - [70, 60]) == pytest.approx(25)
