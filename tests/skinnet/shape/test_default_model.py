"""The embedded face is one symmetric disc with modes, a chart and landmarks in their places."""

import numpy as np
import pytest
import torch

from skinnet.errors import InputError
from skinnet.mesh._orientation import is_inside_out, label_face_components
from skinnet.mesh._topology import list_boundary_loops
from skinnet.shape._default_model import MODES, build_default_model, build_procedural_model
from skinnet.shape._ibug import IBUG
from skinnet.shape._procedural_head import CHART_EXTENT, IDENTITY_SIZE, compute_head_radius


def find_partners() -> np.ndarray:
    """For each vertex the one at its mirror image."""
    mean = build_default_model().mean
    order, image = np.lexsort(mean.T), np.lexsort((mean * [-1, 1, 1]).T)
    partner = np.empty(len(mean), int)
    partner[image] = order
    return partner


def test_it_is_a_face_of_the_size_of_one() -> None:
    model = build_default_model()
    assert 5500 < len(model.mean) < 6500 and len(model.variances) == MODES
    assert np.ptp(model.mean[:, 1]) == pytest.approx(180) and model.millimetres == 1
    assert 130 < np.ptp(model.mean[:, 0]) < 160


def test_it_is_one_disc_that_looks_outside() -> None:
    model = build_default_model()
    assert len(list_boundary_loops(model.triangles)) == 1
    assert label_face_components(model.triangles).max() == 0
    assert len(np.unique(model.triangles)) == len(model.mean)
    edges = 3 * len(model.triangles) + len(list_boundary_loops(model.triangles)[0])
    assert len(model.mean) - edges / 2 + len(model.triangles) == 1
    assert not is_inside_out(model.mean, model.triangles)


def test_it_is_its_own_mirror_image_to_the_last_bit() -> None:
    model, partner = build_default_model(), find_partners()
    assert np.array_equal(model.mean[partner], model.mean * [-1, 1, 1])
    assert np.array_equal(model.basis[:, partner], model.basis * [-1, 1, 1])
    triangles, images = np.sort(model.triangles, 1), np.sort(partner[model.triangles], 1)
    assert np.array_equal(np.unique(triangles, axis=0), np.unique(images, axis=0))
    assert np.allclose(model.uv[partner], [1, 0] + model.uv * [-1, 1], atol=1e-15)


def test_modes_are_orthonormal_and_ordered() -> None:
    model = build_default_model()
    rows = model.basis.reshape(MODES, -1)
    assert np.allclose(rows @ rows.T, np.eye(MODES), atol=1e-9)
    assert (np.diff(model.variances) < 0).all() and model.variances[-1] > 0


def test_a_sampled_head_lies_on_the_model() -> None:
    model = build_default_model()
    rng = torch.Generator().manual_seed(5)
    numbers = torch.randn(1, IDENTITY_SIZE, generator=rng, dtype=torch.float64)
    radius = compute_head_radius(numbers, 115, 153)[0, 0].numpy()
    column = np.rint(model.uv[:, 0] * 152).astype(int)
    row = np.rint((1 - model.uv[:, 1]) * 114).astype(int)
    mean_radius = np.linalg.norm(model.mean, axis=1)
    mean_relief = compute_head_radius(torch.zeros_like(numbers), 115, 153)[0, 0].numpy()
    scale = np.median(mean_radius / mean_relief[row, column])
    head = (scale * radius[row, column] / mean_radius)[:, None] * model.mean
    rows = model.basis.reshape(MODES, -1)
    alpha = rows @ (head - model.mean).ravel()
    assert np.linalg.norm(model.reconstruct(alpha) - head, axis=1).max() < 0.5
    assert np.abs(alpha / np.sqrt(model.variances)).max() < 5


def test_the_texture_space_is_the_chart() -> None:
    model = build_default_model()
    azimuth = np.arctan2(model.mean[:, 0], model.mean[:, 2])
    elevation = np.arcsin(model.mean[:, 1] / np.linalg.norm(model.mean, axis=1))
    chart = np.stack([azimuth / CHART_EXTENT[0], elevation / CHART_EXTENT[1]], 1)
    assert np.allclose(model.uv, (chart + 1) / 2, atol=1e-7)


def test_landmarks_are_where_the_features_are() -> None:
    model = build_default_model()
    assert list(model.landmarks) == list(IBUG)
    at = {name: model.mean[vertex] for name, vertex in model.landmarks.items()}
    for name, point in at.items():
        side = point[0]
        assert (side > 0) == ("left" in name) and (side < 0) == ("right" in name)
        other = name.replace("left", "right")
        assert np.array_equal(at[other][1:], point[1:]) and abs(at[other][0]) == abs(side)
    down = ["nose_bridge", "nose_tip", "nose_base", "mouth_top", "lips_upper", "lips_lower"]
    heights = [at[name][1] for name in (*down, "mouth_bottom", "chin")]
    assert heights == sorted(heights, reverse=True)
    assert at["nose_tip"][2] > model.mean[:, 2].max() - 1
    assert at["left_brow_outer"][1] > at["left_eye_outer"][1] > at["left_nostril"][1]
    assert at["left_eye_outer"][0] > at["mouth_left"][0] > at["left_nostril"][0]


def test_a_finer_grid_is_the_same_face() -> None:
    fine = build_procedural_model(151, 201)
    assert len(fine.mean) > 1.6 * len(build_default_model().mean)
    ratio = (
        fine.variances
        / len(fine.mean)
        / (build_default_model().variances / len(build_default_model().mean))
    )
    assert np.allclose(ratio[:10], 1, rtol=0.03)


def test_it_is_made_once_and_always_the_same() -> None:
    assert build_default_model() is build_default_model()
    again = build_procedural_model()
    assert np.array_equal(again.mean, build_default_model().mean)
    assert np.array_equal(again.basis, build_default_model().basis)


@pytest.mark.parametrize(("rows", "columns"), [(115, 152), (5, 7)])
def test_grids_without_a_middle_or_features_are_refused(rows: int, columns: int) -> None:
    with pytest.raises(InputError, match=f"odd number of columns .* got {rows} and {columns}"):
        build_procedural_model(rows, columns)
