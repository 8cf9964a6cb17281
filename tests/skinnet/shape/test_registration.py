"""A model is fitted to scans made from it, and scans that do not fit are refused in words."""

import numpy as np
import pytest

from benchmarks.fit import make_big_model, make_case
from skinnet.errors import InputError
from skinnet.mesh.mesh import Mesh
from skinnet.shape.fit_settings import FitSettings
from skinnet.shape.model import ShapeModel
from skinnet.shape.registration import _fit_to_landmarks, register
from skinnet.shape.similarity import Similarity

VERTICES, MODES = 1500, 12


@pytest.fixture(scope="module")
def model() -> ShapeModel:
    return make_big_model(VERTICES, MODES)


@pytest.mark.parametrize("seed", range(3))
def test_a_torn_noisy_scan_is_recovered(model: ShapeModel, seed: int) -> None:
    made = make_case(model, seed)
    found = register(model, made.scan, made.landmarks)
    surface, vertices = made.measure_error(found, model.triangles)
    assert found.converged
    assert surface < 0.3
    assert vertices < 1.0
    assert found.millimetres == pytest.approx(1 / made.pose.scale, rel=0.01)


def test_the_papers_settings_recover_a_whole_clean_scan(model: ShapeModel) -> None:
    made = make_case(model, 5, missing=0, outliers=0, noise=1)
    paper = FitSettings(normals=False, map_weight=0.0)
    surface, _ = made.measure_error(
        register(model, made.scan, made.landmarks, paper), model.triangles
    )
    assert surface < 0.3


def test_the_record_says_what_was_done(model: ShapeModel) -> None:
    made = make_case(model, 0)
    lines: list[str] = []
    settings = FitSettings(stages=((400, 5, 1.0), (0, 0, 0.0)))
    found = register(model, made.scan, made.landmarks, settings, lines.append)
    assert [(stage.vertices, stage.modes) for stage in found.record] == [
        (400, 5),
        (VERTICES, MODES),
    ]
    assert len(lines) == 2
    assert "a made scan: 400 vertices, 5 modes" in lines[0]
    assert found.vertices.shape == (VERTICES, 3)
    np.testing.assert_allclose(
        found.pose(model.reconstruct(found.alpha)), found.vertices, rtol=1e-4
    )
    assert found.kept.mean() <= 0.8 + 1 / VERTICES
    assert found.rms == pytest.approx(np.sqrt(np.mean(found.distances[found.kept] ** 2)))


def test_a_fit_is_the_same_twice(model: ShapeModel) -> None:
    made = make_case(model, 1)
    first, second = (register(model, made.scan, made.landmarks) for _ in range(2))
    np.testing.assert_array_equal(first.vertices, second.vertices)


def test_a_heavy_prior_keeps_to_the_mean(model: ShapeModel) -> None:
    made = make_case(model, 2)
    sizes = [
        np.linalg.norm(register(model, made.scan, made.landmarks, settings).alpha)
        for settings in (FitSettings(), FitSettings(map_weight=1e6))
    ]
    assert sizes[1] < 0.05 * sizes[0]


def test_a_fit_without_iterations_left_says_so(model: ShapeModel) -> None:
    made = make_case(model, 0)
    found = register(model, made.scan, made.landmarks, FitSettings(iterations=1))
    assert not found.converged


def test_landmarks_alone_give_pose_and_size(model: ShapeModel) -> None:
    made = make_case(model, 0, noise=0)
    pose, alpha = _fit_to_landmarks(model, made.landmarks)
    assert pose.scale == pytest.approx(made.pose.scale, rel=0.05)
    rows = [model.landmarks[name] for name in made.landmarks]
    error = pose(model.reconstruct(alpha))[rows] - np.stack(list(made.landmarks.values()))
    assert np.sqrt(np.mean(error**2)) / made.pose.scale < 1.0


def test_a_start_takes_the_place_of_landmarks(model: ShapeModel) -> None:
    made = make_case(model, 0)
    by_landmarks, _ = _fit_to_landmarks(model, made.landmarks)
    found = register(model, made.scan, start=by_landmarks)
    surface, vertices = made.measure_error(found, model.triangles)
    assert found.converged and surface < 0.3 and vertices < 1.0
    far = Similarity(np.eye(3), made.pose.scale, made.pose.translation + 1000 * made.pose.scale)
    with pytest.raises(InputError, match="a made scan: nothing lies near the model"):
        register(model, made.scan, start=far)


def test_neither_landmarks_nor_a_start_is_refused_in_a_sentence(model: ShapeModel) -> None:
    made = make_case(model, 0)
    sentence = r"a made scan has neither landmarks nor a start; give one of the two\."
    with pytest.raises(InputError, match=sentence):
        register(model, made.scan)


def test_too_few_common_landmarks_are_refused(model: ShapeModel) -> None:
    made = make_case(model, 0)
    few = dict(list(made.landmarks.items())[:3])
    with pytest.raises(InputError, match=r"have 3 landmarks in common.*mark_0"):
        register(model, made.scan, few)


def test_a_scan_with_nothing_near_the_model_is_refused(model: ShapeModel) -> None:
    made = make_case(model, 0)
    far = made.scan.vertices + 1000 * made.pose.scale
    with pytest.raises(InputError, match="a made scan: nothing lies near the model"):
        register(model, Mesh(far, made.scan.triangles, name="a made scan"), made.landmarks)


def test_a_scan_turned_inside_out_is_refused(model: ShapeModel) -> None:
    made = make_case(model, 0)
    inside = Mesh(made.scan.vertices, made.scan.triangles[:, ::-1].copy(), name="a made scan")
    with pytest.raises(InputError, match="with a similar normal"):
        register(model, inside, made.landmarks)


def test_a_scan_of_lone_points_is_refused(model: ShapeModel) -> None:
    made = make_case(model, 0)
    cloud = Mesh(made.scan.vertices, made.scan.triangles[:0], name="a cloud")
    with pytest.raises(InputError, match="a cloud has no surface"):
        register(model, cloud, made.landmarks)
