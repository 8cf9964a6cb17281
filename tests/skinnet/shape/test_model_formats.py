"""Shape models are read from every layout, and arrays that do not belong together are refused."""

import json
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
from scipy.io import savemat
from small_meshes import LANDMARKS, dome, small_model

from skinnet.errors import InputError
from skinnet.mesh._orientation import flip_triangles, is_inside_out
from skinnet.mesh.mesh import Mesh
from skinnet.shape._default_model import build_default_model
from skinnet.shape._ibug import IBUG
from skinnet.shape.model import ShapeModel
from skinnet.shape.model_formats import load_shape_model, save_shape_model

Writer = Callable[[Path, dict[str, Any]], None]


def own_arrays(path: Path) -> dict[str, Any]:
    save_shape_model(path, small_model())
    with np.load(path) as file:
        return dict(file)


def basel_2009(model: ShapeModel) -> dict[str, Any]:
    """The layout of 01_MorphableModel.mat: micrometres, faces from one that look inside."""
    return {
        "shapeMU": (1000 * model.mean).reshape(-1, 1).astype(np.float32),
        "shapePC": model.basis.reshape(len(model.basis), -1).T.astype(np.float32),
        "shapeEV": 1000 * np.sqrt(model.variances)[:, None].astype(np.float32),
        "tl": model.triangles[:, [0, 2, 1]] + 1.0,
        "texMU": np.zeros((model.mean.size, 1)),
    }


def basel_2017(model: ShapeModel) -> dict[str, Any]:
    """The layout of model2017-1_face12_nomouth.h5."""
    marks = [
        {"id": "center.nose.tip", "coordinates": (model.mean[31] + 0.1).tolist()},
        {"id": "center.front.trichion", "coordinates": [0, 90, 100]},
        {"id": "left.eye.corner_outer", "coordinates": model.mean[19].tolist()},
    ]
    return {
        "shape/model/mean": model.mean.ravel().astype(np.float32),
        "shape/model/pcaBasis": model.basis.reshape(len(model.basis), -1).T.astype(np.float32),
        "shape/model/pcaVariance": model.variances.astype(np.float32),
        "shape/model/noiseVariance": np.float32(0),
        "shape/representer/points": model.mean.T.astype(np.float32),
        "shape/representer/cells": model.triangles.T.astype(np.int32),
        "shape/version/majorVersion": np.int32(0),
        "metadata/landmarks/json": json.dumps(marks),
    }


def write_h5(path: Path, arrays: dict[str, Any]) -> None:
    with h5py.File(path, "w") as file:
        for name, array in arrays.items():
            file[name] = array


def write_npz(path: Path, arrays: dict[str, Any]) -> None:
    np.savez(path, **arrays)


def write_quads(path: Path, vertices: np.ndarray, mesh: Mesh) -> None:
    """As ICT-FaceKit writes them: a header, one material a part, quads with v/vt."""
    lines = ["# ICT FaceKit", "", "mtllib ICTFaceModelMaterial.mtl"]
    lines += [f"v {x:.9g} {y:.9g} {z:.9g}" for x, y, z in vertices]
    lines += [f"vt {u:.6f} {v:.6f}" for u, v in mesh.uv] + ["vt 1.5 0.5"]
    half = len(mesh.triangles) // 2
    quads = np.c_[mesh.triangles[:half], mesh.triangles[half:, 2]] + 1
    lines += ["usemtl M_Face"] + ["f " + " ".join(f"{i}/{i}" for i in quad) for quad in quads]
    outside = len(mesh.uv) + 1
    lines += ["usemtl M_BackHead", f"f 1/{outside} 2/{outside} 3/{outside}"]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")


def ict_folder(folder: Path, model: ShapeModel) -> Path:
    folder.mkdir()
    mesh = dome()
    mean = model.mean / 10
    write_quads(folder / "generic_neutral_mesh.obj", mean, mesh)
    for number, mode in enumerate(model.basis):
        write_quads(folder / f"identity{number:03d}.obj", mean + mode, mesh)
    write_quads(folder / "browDown_L.obj", mean + 1, mesh)
    listed = {"idx_to_landmark_verts": list(range(63)) + [0] * 5}
    (folder / "vertex_indices.json").write_text(json.dumps(listed))
    return folder


def test_our_own_file_comes_back_exactly(tmp_path: Path) -> None:
    model = small_model()
    save_shape_model(tmp_path / "m.npz", model)
    read = load_shape_model(tmp_path / "m.npz")
    for name in ("mean", "basis", "variances", "triangles", "uv", "uv_triangles"):
        assert np.array_equal(getattr(read, name), getattr(model, name))
    assert dict(read.landmarks) == LANDMARKS and read.millimetres == model.millimetres
    assert list(tmp_path.iterdir()) == [tmp_path / "m.npz"]
    with pytest.raises(InputError, match=r"written as \.npz"):
        save_shape_model(tmp_path / "m.mat", model)


def test_no_path_is_the_embedded_face() -> None:
    assert load_shape_model() is build_default_model()
    assert len(load_shape_model(modes=5).variances) == 5


def test_landmarks_may_be_given_by_file(tmp_path: Path) -> None:
    (tmp_path / "marks.json").write_text(json.dumps({"nose_tip": 3, "8": 4}))
    save_shape_model(tmp_path / "m.npz", small_model())
    read = load_shape_model(tmp_path / "m.npz", landmarks=tmp_path / "marks.json")
    assert read.landmarks == {"nose_tip": 3, "chin": 4}


def test_basel_2009_is_read(tmp_path: Path) -> None:
    model = small_model()
    savemat(tmp_path / "01_MorphableModel.mat", basel_2009(model))
    read = load_shape_model(tmp_path / "01_MorphableModel.mat")
    assert read.millimetres == 1e-3 and not read.landmarks and read.uv is None
    assert np.allclose(read.mean, 1000 * model.mean, rtol=1e-6)
    assert np.allclose(read.basis, model.basis, atol=1e-6)
    assert np.allclose(read.variances, 1e6 * model.variances, rtol=1e-6)
    assert np.array_equal(read.triangles, model.triangles)


def test_basel_2017_is_read(tmp_path: Path) -> None:
    model = small_model()
    write_h5(tmp_path / "m.h5", basel_2017(model))
    read = load_shape_model(tmp_path / "m.h5")
    assert read.millimetres == 1
    assert np.allclose(read.mean, model.mean, rtol=1e-6)
    assert np.allclose(read.basis, model.basis, atol=1e-6)
    assert np.allclose(read.variances, model.variances, rtol=1e-6)
    assert np.array_equal(read.triangles, model.triangles)
    assert dict(read.landmarks) == {"nose_tip": 31, "left_eye_outer": 19}


def test_statismos_older_scaled_columns_are_made_unit_vectors(tmp_path: Path) -> None:
    model = small_model()
    arrays = basel_2017(model)
    arrays["shape/model/pcaBasis"] = arrays["shape/model/pcaBasis"] * np.sqrt(model.variances)
    arrays.pop("metadata/landmarks/json")
    write_h5(tmp_path / "m.h5", arrays)
    read = load_shape_model(tmp_path / "m.h5")
    assert np.allclose(read.basis, model.basis, atol=1e-6) and not read.landmarks


def test_the_folder_of_ict_facekit_is_read(tmp_path: Path) -> None:
    model = small_model()
    folder = ict_folder(tmp_path / "FaceXModel", model)
    for path in (folder, tmp_path):
        read = load_shape_model(path)
        assert read.millimetres == 10 and np.array_equal(read.variances, np.ones(3))
        assert np.allclose(read.mean, model.mean / 10, atol=1e-8)
        assert np.allclose(read.basis, model.basis, atol=1e-6)
        assert len(read.triangles) == len(model.triangles) and read.uv.max() <= 1
        assert read.landmarks["chin"] == 8 and read.landmarks["right_eye_outer"] == 36


def test_faults_in_the_folder_of_ict_facekit_name_the_file(tmp_path: Path) -> None:
    folder = ict_folder(tmp_path / "FaceXModel", small_model())
    (folder / "vertex_indices.json").write_text('{"idx_to_landmark_verts": [70]}')
    with pytest.raises(InputError, match=r"vertex_indices\.json has no usable landmarks"):
        load_shape_model(folder)
    (folder / "vertex_indices.json").unlink()
    assert not load_shape_model(folder).landmarks
    (folder / "identity001.obj").write_text("v 0 0 0\n")
    with pytest.raises(InputError, match=r"identity001\.obj has 1 vertices, and generic.* has 63"):
        load_shape_model(folder)
    for path in folder.glob("identity*"):
        path.unlink()
    with pytest.raises(InputError, match=r"FaceXModel has generic_neutral_mesh\.obj, but no ident"):
        load_shape_model(folder)


@pytest.mark.parametrize(
    ("change", "fault"),
    [
        ({"mean": np.zeros((62, 3))}, "its basis is [3, 63, 3] and does not agree with its mean"),
        ({"mean": np.zeros((3, 63))}, "its mean is [3, 63]"),
        ({"basis": np.zeros((3, 189))}, "its basis is [3, 189] and does not agree"),
        ({"variances": np.ones(2)}, "it has 3 modes and variances [2]"),
        ({"variances": np.array([1, -1.0, 1])}, "a variance is -1, and none is negative"),
        ({"mean": np.full((63, 3), np.nan)}, "its mean has values that are NaN or infinite"),
        ({"basis": np.full((3, 63, 3), np.inf)}, "its basis has values that are NaN or infinite"),
        ({"triangles": np.array([[0, 1, 63]])}, "its triangles go from 0 to 63 of 63 vertices"),
        ({"triangles": np.zeros((0, 3), int)}, "its triangles are [0, 3]"),
        ({"uv_triangles": np.zeros((5, 3), int)}, "it has triangles [96, 3], and [5, 3] for its"),
        ({"uv": np.zeros((5, 2))}, "its triangles go from 0 to 62 of 5 texture coordinates"),
        ({"uv": np.zeros((63, 3))}, "its texture coordinates are not [points, 2]"),
        ({"landmark_vertices": np.array([1, 2, 3, 4, 5, 99])}, "landmark chin is vertex 99 of 63"),
        ({"landmark_vertices": np.array([1])}, "is not a complete shape model"),
        ({"millimetres": np.array(0.0)}, "its unit is 0.0 millimetres"),
        ({"mean": np.array(["a"])}, "is not a complete shape model"),
        ({"skinnet_shape_model": np.array("2")}, "has version 2, and this skinnet reads version 1"),
    ],
)
def test_arrays_that_do_not_belong_together_are_refused(
    tmp_path: Path, change: dict[str, np.ndarray], fault: str
) -> None:
    path = tmp_path / "m.npz"
    write_npz(path, own_arrays(path) | change)
    with pytest.raises(InputError, match=rf"m\.npz .*{re.escape(fault)}"):
        load_shape_model(path)


@pytest.mark.parametrize(
    ("name", "layout", "write"),
    [("m.mat", basel_2009, savemat), ("m.h5", basel_2017, write_h5)],
)
def test_basel_files_whose_arrays_disagree_are_refused(
    tmp_path: Path, name: str, layout: Callable[[ShapeModel], dict[str, Any]], write: Writer
) -> None:
    arrays = layout(small_model())
    mean, basis, variances = list(arrays)[:3]
    faults = {
        "its mean has 188 numbers": {mean: arrays[mean][:-1]},
        "its basis is": {basis: arrays[basis][:-3]},
        "3 modes and variances": {variances: arrays[variances][:2]},
        "basis has values that are NaN": {basis: arrays[basis] * np.nan},
    }
    for fault, change in faults.items():
        write(tmp_path / name, arrays | change)
        with pytest.raises(InputError, match=rf"{name} is not a usable shape model: .*{fault}"):
            load_shape_model(tmp_path / name)
    arrays.pop(basis)
    write(tmp_path / name, arrays)
    with pytest.raises(InputError, match=rf"{name} is not a Basel Face Model of 20"):
        load_shape_model(tmp_path / name)


@pytest.mark.parametrize("name", ["m.npz", "m.mat", "m.h5"])
def test_files_that_are_no_models_are_refused(tmp_path: Path, name: str) -> None:
    (tmp_path / name).write_bytes(b"PK\x03\x04 something else")
    with pytest.raises(InputError, match=f"{name} is not an? "):
        load_shape_model(tmp_path / name)


def test_other_files_and_missing_ones_are_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"There is no shape model .*none\.npz"):
        load_shape_model(tmp_path / "none.npz")
    (tmp_path / "m.txt").write_text("")
    with pytest.raises(InputError, match=r"m\.txt is not a shape model; give \.npz, \.mat"):
        load_shape_model(tmp_path / "m.txt")
    write_npz(tmp_path / "m.npz", {"maps": np.zeros(3)})
    with pytest.raises(InputError, match=r"m\.npz holds maps, which is not a shape model"):
        load_shape_model(tmp_path / "m.npz")


def test_python_objects_are_never_unpickled(tmp_path: Path) -> None:
    path = tmp_path / "m.npz"
    write_npz(path, own_arrays(path) | {"mean": np.array([{"a": 1}], object)})
    with pytest.raises(InputError, match=r"m\.npz is not an \.npz of plain arrays"):
        load_shape_model(path)


def test_ict_facekit_loads_as_the_face(shared_data: Path) -> None:
    model = load_shape_model(shared_data / "models/ict_facekit.npz")
    assert model.mean.shape == (9409, 3) and model.basis.shape == (100, 9409, 3)
    assert len(model.triangles) == 18460 and model.millimetres == 10
    assert 0 <= model.uv.min() and model.uv.max() <= 1 and len(model.uv) == 9409
    assert len(model.landmarks) == 68 and set(IBUG) <= model.landmarks.keys()
    at = {name: model.mean[vertex] for name, vertex in model.landmarks.items()}
    assert at["left_eye_outer"][0] > 0 > at["right_eye_outer"][0]
    assert at["nose_tip"][2] > at["chin"][2] and at["nose_bridge"][1] > at["chin"][1]
    assert not is_inside_out(model.mean, model.triangles)
    assert is_inside_out(model.mean, flip_triangles(model.triangles, np.ones(18460, bool)))


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("mean", lambda mean: mean + 1j),
        ("variances", lambda variances: np.array(["1", "2", "3"])),
        ("basis", lambda basis: basis[:0]),
        ("triangles", lambda triangles: triangles + 0.5),
        ("triangles", lambda triangles: np.where(triangles == 0, np.nan, triangles)),
        ("landmark_vertices", lambda vertices: vertices + 0.5),
        ("millimetres", lambda unit: np.array(np.inf)),
    ],
)
def test_arrays_of_another_kind_are_refused(
    tmp_path: Path, name: str, value: Callable[[Any], Any]
) -> None:
    path = tmp_path / "m.npz"
    arrays = own_arrays(path)
    write_npz(path, arrays | {name: value(arrays[name])})
    with pytest.raises(InputError, match=r"m\.npz is not a (complete|usable) shape model"):
        load_shape_model(path)


@pytest.mark.parametrize(
    "change",
    [
        {"shapePC": np.zeros((0, 3)), "shapeMU": np.zeros((0, 1))},
        {"shapePC": np.zeros((189, 0)), "shapeEV": np.zeros((0, 1))},
        {"tl": np.full((96, 3), np.nan)},
        {"shapeEV": np.full((3, 1), 1e300)},
        {"shapeEV": np.full((3, 1), 1j)},
    ],
)
def test_a_damaged_basel_model_is_refused(tmp_path: Path, change: dict[str, Any]) -> None:
    savemat(tmp_path / "a.mat", basel_2009(small_model()) | change)
    with pytest.raises(InputError, match=r"a\.mat is not a (usable shape model|Basel Face Model)"):
        load_shape_model(tmp_path / "a.mat")


def test_a_model_without_areas_has_no_inside(tmp_path: Path) -> None:
    flat = basel_2017(small_model())
    flat["shape/model/mean"] = np.zeros_like(flat["shape/model/mean"])
    write_h5(tmp_path / "a.h5", flat)
    assert not load_shape_model(tmp_path / "a.h5").mean.any()
