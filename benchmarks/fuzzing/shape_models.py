"""Shape models of other programs: the Basel Face Models in .mat and .h5, and folders of meshes."""

import io
import json
import tempfile
from functools import cache
from pathlib import Path
from random import Random
from typing import Any

import h5py
import numpy as np
from scipy.io import savemat

from benchmarks.fuzzing.archives import change_archive, change_numbers
from benchmarks.fuzzing.case import Case
from benchmarks.fuzzing.changes import EXTREME_VALUES, change_bytes, change_text
from benchmarks.fuzzing.small_shapes import make_dome, make_model
from skinnet.mesh import write_mesh
from skinnet.shape import load_shape_model


def make(rng: Random) -> Case:
    """Make a damaged shape model, which is read and truncated."""
    kind = rng.choice(("mat", "h5", "ict", "folder"))
    if kind == "folder":
        return Case(_read("model"), _write_folder(rng), kind)
    arrays = _make_arrays(kind)
    if rng.random() < 0.6:
        arrays = _change_arrays(arrays, rng)
    name = {"mat": "model.mat", "h5": "model.h5", "ict": "model.npz"}[kind]
    data = _WRITERS[kind](arrays)
    if rng.random() < 0.5:
        change = change_archive if kind == "ict" and rng.random() < 0.5 else change_bytes
        data = change(data, rng)
    return Case(_read(name), {name: data}, kind)


def _read(name: str) -> Any:
    def read(folder: Path) -> None:
        model = load_shape_model(folder / name)
        shape = model.reconstruct(np.ones(len(model.variances)))
        assert np.isfinite(shape).all() and len(model.triangles)
        assert 0 <= model.triangles.min() and model.triangles.max() < len(model.mean)
        model.truncate(1)

    return read


def _change_arrays(arrays: dict[str, Any], rng: Random) -> dict[str, Any]:
    name, changed = rng.choice(list(arrays)), dict(arrays)
    match rng.randrange(8):
        case 0:
            del changed[name]
        case 1:
            changed[name] = arrays[rng.choice(list(arrays))]
        case 2:
            changed[name] = np.array(rng.choice(("x", 0, -1, 1e300, [])))
        case _ if isinstance(arrays[name], np.ndarray) and arrays[name].dtype.kind in "fiu":
            changed[name] = change_numbers(arrays[name], rng)
    return changed


@cache
def _make_arrays(kind: str) -> dict[str, Any]:
    model = make_model()
    modes = model.basis.reshape(len(model.basis), -1).T.astype(np.float32)
    if kind == "mat":
        return {
            "shapeMU": (1000 * model.mean).reshape(-1, 1).astype(np.float32),
            "shapePC": modes,
            "shapeEV": 1000 * np.sqrt(model.variances)[:, None].astype(np.float32),
            "tl": model.triangles[:, [0, 2, 1]] + 1.0,
        }
    if kind == "h5":
        marks = [{"id": "center.nose.tip", "coordinates": model.mean[31].tolist()}]
        return {
            "shape/model/mean": model.mean.ravel().astype(np.float32),
            "shape/model/pcaBasis": modes,
            "shape/model/pcaVariance": model.variances.astype(np.float32),
            "shape/representer/cells": model.triangles.T.astype(np.int32),
            "metadata/landmarks/json": json.dumps(marks),
        }
    return {
        "verts": model.mean.astype(np.float32),
        "id_modes": model.basis.astype(np.float32),
        "tris": model.triangles.astype(np.int32),
        "uv": np.asarray(model.uv, np.float32),
        "tris_uv": model.triangles.astype(np.int32),
        "landmarks68": np.arange(68, dtype=np.int32) % 60,
        "face_vertex_count": np.array(len(model.mean)),
    }


def _write_mat(arrays: dict[str, Any]) -> bytes:
    file = io.BytesIO()
    savemat(file, arrays)
    return file.getvalue()


def _write_h5(arrays: dict[str, Any]) -> bytes:
    file = io.BytesIO()
    with h5py.File(file, "w") as archive:
        for name, array in arrays.items():
            archive[name] = (
                str(array) if getattr(array, "dtype", None) == np.dtype("<U1") else array
            )
    return file.getvalue()


def _write_npz(arrays: dict[str, Any]) -> bytes:
    file = io.BytesIO()
    np.savez(file, **arrays)
    return file.getvalue()


_WRITERS = {"mat": _write_mat, "h5": _write_h5, "ict": _write_npz}


def _write_folder(rng: Random) -> dict[str, bytes]:
    """A folder of registered meshes, one of which is changed."""
    files = {f"model/{at}.obj": data for at, data in enumerate(_make_meshes())}
    name = rng.choice(list(files))
    files[name] = change_text(files[name], rng)
    if rng.random() < 0.2:
        files["model/notes.txt"] = repr(rng.choice(EXTREME_VALUES)).encode()
    return files


@cache
def _make_meshes() -> list[bytes]:
    found = []
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "a.obj")
        for scale in (1.0, 1.02, 0.97):
            mesh = make_dome()
            write_mesh(path, type(mesh)(mesh.vertices * [scale, 1, 1], mesh.triangles))
            found.append(path.read_bytes())
    return found
