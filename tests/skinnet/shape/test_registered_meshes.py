"""Registered meshes become a model; meshes that do not correspond are refused."""

from pathlib import Path

import numpy as np
import pytest
from small_meshes import dome, small_model

from skinnet.errors import InputError
from skinnet.mesh.mesh import Mesh
from skinnet.mesh.mesh_file import write_mesh
from skinnet.shape.model_formats import load_shape_model
from skinnet.shape.registered_meshes import build_shape_model


def same_span(one: np.ndarray, other: np.ndarray) -> bool:
    """Whether orthonormal modes span the same space."""
    a, b = one.reshape(len(one), -1), other.reshape(len(other), -1)
    return np.allclose(np.linalg.svd(a @ b.T)[1], 1, atol=1e-6)


def subjects(count: int, modes: int = 3) -> list[Mesh]:
    model = small_model(modes)
    rng = np.random.default_rng(2)
    alphas = rng.normal(size=(count, modes)) * np.sqrt(model.variances)
    alphas -= alphas.mean(0)
    return [model.build_mesh(alpha) for alpha in alphas]


def test_a_model_of_registered_meshes_has_their_modes(tmp_path: Path) -> None:
    meshes = subjects(6)
    model = build_shape_model(meshes, align=False, name="six")
    assert len(model.variances) == 3 and model.millimetres == 1
    assert np.allclose(model.mean, small_model().mean, atol=1e-6)
    assert same_span(model.basis, small_model().basis)
    alphas = np.stack([(mesh.vertices - model.mean).ravel() for mesh in meshes])
    alphas = alphas @ model.basis.reshape(3, -1).T
    assert np.allclose(alphas.var(0, ddof=1), model.variances)
    assert np.array_equal(model.uv, meshes[0].uv)


@pytest.mark.parametrize("suffix", [".obj", ".ply"])
def test_a_folder_of_registered_meshes_is_a_model(tmp_path: Path, suffix: str) -> None:
    meshes = subjects(5)
    for number, mesh in enumerate(meshes):
        write_mesh(tmp_path / f"{number}{suffix}", mesh)
    model = load_shape_model(tmp_path, align=False, modes=2)
    expected = build_shape_model(meshes, align=False)
    assert np.allclose(model.mean, expected.mean, atol=1e-6)
    assert np.array_equal(model.triangles, expected.triangles)
    assert np.allclose(model.variances, expected.variances[:2], rtol=1e-5)
    assert np.allclose(model.uv[model.uv_triangles], dome().uv[dome().uv_triangles], atol=1e-6)


def test_lips_that_touch_in_one_subject_stay_apart(tmp_path: Path) -> None:
    meshes = subjects(3)
    meshes[0].vertices[31] = meshes[0].vertices[30]
    for number, mesh in enumerate(meshes):
        write_mesh(tmp_path / f"{number}.obj", mesh)
    assert len(load_shape_model(tmp_path).mean) == 63


def test_alignment_takes_pose_and_size_out_of_the_modes() -> None:
    rng = np.random.default_rng(3)
    posed = []
    for mesh in subjects(6):
        rotation = np.linalg.qr(np.eye(3) + 0.1 * rng.normal(size=(3, 3)))[0]
        rotation *= np.sign(np.diag(rotation))
        vertices = (1 + 0.05 * rng.normal()) * mesh.vertices @ rotation.T + 30 * rng.normal(size=3)
        posed.append(Mesh(vertices, mesh.triangles, name=mesh.name))
    free, aligned = build_shape_model(posed, align=False), build_shape_model(posed)
    assert aligned.variances.sum() < 0.1 * free.variances.sum()
    assert aligned.variances.sum() < 2 * build_shape_model(subjects(6)).variances.sum()


def test_fewer_subjects_than_modes_are_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="six: 6 subjects give at most 5 modes, and 6 are asked"):
        build_shape_model(subjects(6), modes=6, name="six")
    with pytest.raises(InputError, match="six has 3 modes, and 5 are asked for"):
        build_shape_model(subjects(6), modes=5, align=False, name="six")
    with pytest.raises(InputError, match="1 subjects give at most 0 modes"):
        build_shape_model(subjects(1))
    with pytest.raises(InputError, match="all subjects have the same shape"):
        build_shape_model([dome(), dome()], align=False)
    with pytest.raises(InputError, match=r"\d+ has no meshes"):
        load_shape_model(tmp_path)


def test_meshes_that_do_not_correspond_are_named(tmp_path: Path) -> None:
    one, other, last = subjects(3)
    shorter = Mesh(other.vertices[:-1], other.triangles[:10], name="b.obj")
    with pytest.raises(InputError, match=r"b\.obj has 62 vertices and small 63"):
        build_shape_model([one, shorter])
    turned_over = Mesh(last.vertices, last.triangles[::-1], name="c.obj")
    with pytest.raises(InputError, match=r"c\.obj and small have different faces"):
        build_shape_model([one, other, turned_over])
    other.vertices[3] = np.nan
    with pytest.raises(InputError, match="small has vertices that are NaN"):
        build_shape_model([one, other])


def test_a_unit_may_be_given_where_it_cannot_be_guessed() -> None:
    tiny = [Mesh(mesh.vertices / 60, mesh.triangles) for mesh in subjects(3)]
    with pytest.raises(InputError, match="is 3 units long, which is no face"):
        build_shape_model(tiny)
    assert build_shape_model(tiny, millimetres=60.0).millimetres == 60
