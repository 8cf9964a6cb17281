"""Views: rays go where points are projected, and a face fills the picture the right way around."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from skinnet.errors import InputError
from skinnet.render._view_axes import compute_view_axes
from skinnet.render.views import OrthographicView, PerspectiveView, View, frame_face

HEAD = np.random.default_rng(0).normal(size=(500, 3)) * [70, 100, 80] + [3, -20, 40]


def views() -> list[View]:
    axes = compute_view_axes(25.0, 10.0)
    return [
        PerspectiveView((30, 40), 5 * axes[2], axes, 55.0),
        OrthographicView((30, 40), 5 * axes[2], axes, 12.0),
    ]


@pytest.mark.parametrize("view", views())
@pytest.mark.parametrize("samples", [1, 3])
def test_a_point_on_a_ray_is_projected_to_its_pixel(view: View, samples: int) -> None:
    origins, directions = view.rays(samples)
    assert origins.shape == (30 * 40 * samples**2, 3)
    assert np.allclose(np.linalg.norm(directions, axis=1), 1)
    row, column = np.mgrid[: 30 * samples, : 40 * samples]
    centres = (np.stack([column, row], -1).reshape(-1, 2) + 0.5) / samples
    assert np.allclose(view.project(origins + 4 * directions), centres)


def test_from_the_front_up_is_up_and_the_left_side_is_at_the_right() -> None:
    view = frame_face(HEAD, (200, 160))
    up, left, middle = view.project(HEAD.mean(0) + [[0, 50, 0], [50, 0, 0], [0, 0, 0]])
    assert up[1] < middle[1] - 5 and left[0] > middle[0] + 5
    side = frame_face(HEAD, (200, 160), yaw=90.0)
    assert np.allclose(side.rotation[2], [1, 0, 0])
    assert np.allclose(frame_face(HEAD, (200, 160), pitch=90.0).rotation[2], [0, 1, 0])


@given(st.floats(-180, 180), st.floats(-80, 80), st.floats(5, 70), st.sampled_from([120, 200, 333]))
def test_the_whole_face_is_inside_the_frame(
    yaw: float, pitch: float, field_of_view: float, width: int
) -> None:
    view = frame_face(HEAD, (200, width), yaw, pitch, field_of_view, fill=0.9)
    assert np.allclose(view.rotation @ view.rotation.T, np.eye(3), atol=1e-12)
    assert np.linalg.det(view.rotation) > 0
    share = np.abs(view.project(HEAD) / [width / 2, 100] - 1)
    assert share.max() == pytest.approx(0.9, abs=1e-9)


def test_a_picture_without_pixels_is_refused() -> None:
    with pytest.raises(InputError, match="0 x 20"):
        frame_face(HEAD, (0, 20))
