"""Shape models read from files of any of the known layouts, and written to our own."""

import zipfile
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from skinnet.errors import InputError
from skinnet.files import READ_ERRORS, write_atomically
from skinnet.mesh._mesh_parts import MESH_SUFFIXES
from skinnet.shape._basel import load_basel_2009, load_basel_2017
from skinnet.shape._default_model import build_default_model
from skinnet.shape._ict import NEUTRAL, ict_from_arrays, load_ict_folder
from skinnet.shape.landmarks import read_landmark_vertices
from skinnet.shape.model import ShapeModel, checked_model
from skinnet.shape.registered_meshes import load_registered

VERSION = "1"
"""Version of our own layout, under the key `skinnet_shape_model`."""

_KEY = "skinnet_shape_model"


def load_shape_model(
    path: Path | None = None,
    landmarks: Path | None = None,
    modes: int | None = None,
    align: bool = True,
    millimetres: float | None = None,
) -> ShapeModel:
    """A shape model, by what lies at `path`; None is the embedded procedural face.

    Read are our own .npz (`save_shape_model`) and ICT-FaceKit's, its folder FaceXModel or the one
    above, the Basel Face Models of 2009 (.mat) and 2017 and 2019 (.h5), and a folder of registered
    meshes, of which a model is built; `align` and `millimetres` are for these (`build_shape_model`).
    `landmarks` is a .json file of names and vertex numbers that takes the place of the model's own.
    `modes` keeps the first ones. Nothing is unpickled.

    Raises `InputError` for a path where there is no model, and for models that are damaged.
    """
    model = build_default_model() if path is None else _load(Path(path), align, millimetres)
    if landmarks is not None:
        marks = read_landmark_vertices(Path(landmarks), len(model.mean))
        model = replace(model, landmarks=marks)
    return model if modes is None else model.truncate(modes)


def save_shape_model(path: Path, model: ShapeModel) -> None:
    """Write a model as .npz, whole or not at all."""
    path = Path(path)
    if path.suffix != ".npz":
        raise InputError(f"Shape models are written as .npz; got {path}.")
    arrays: dict[str, Any] = {
        _KEY: np.array(VERSION),
        "mean": model.mean,
        "basis": model.basis,
        "variances": model.variances,
        "triangles": model.triangles,
        "landmark_names": np.array(list(model.landmarks), np.str_),
        "landmark_vertices": np.array(list(model.landmarks.values()), np.int64),
        "millimetres": np.array(model.millimetres),
    }
    if model.uv is not None and model.uv_triangles is not None:
        arrays |= {"uv": model.uv, "uv_triangles": model.uv_triangles}
    with write_atomically(path) as part:
        np.savez(part, **arrays)


def _load(path: Path, align: bool, millimetres: float | None) -> ShapeModel:
    if path.is_dir():
        return _from_folder(path, align, millimetres)
    if not path.is_file():
        raise InputError(f"There is no shape model {path}; check the path.")
    loaders: Mapping[str, Callable[[Path], ShapeModel]] = {
        ".npz": _from_npz,
        ".mat": load_basel_2009,
        ".h5": load_basel_2017,
        ".hdf5": load_basel_2017,
    }
    load = loaders.get(path.suffix.lower())
    if load is None:
        raise InputError(
            f"{path} is no shape model; give {', '.join(loaders)}, ICT-FaceKit's folder or a "
            "folder of registered meshes."
        )
    return load(path)


def _from_folder(folder: Path, align: bool, millimetres: float | None) -> ShapeModel:
    for inner in (folder, folder / "FaceXModel"):
        if (inner / NEUTRAL).is_file():
            return load_ict_folder(inner)
    files = sorted(each for each in folder.iterdir() if each.suffix.lower() in MESH_SUFFIXES)
    return load_registered(files, None, align, millimetres, str(folder))


def _from_npz(path: Path) -> ShapeModel:
    try:
        with path.open("rb") as stream, np.load(stream, allow_pickle=False) as file:
            arrays = {name: file[name] for name in file.files if not name.startswith("expr_")}
    except (zipfile.BadZipFile, *READ_ERRORS) as error:
        raise InputError(
            f"{path} is no .npz of plain arrays, or is cut short ({error}); copy it again."
        ) from error
    read = _own if _KEY in arrays else ict_from_arrays if "id_modes" in arrays else None
    if read is None:
        raise InputError(
            f"{path} holds {', '.join(list(arrays)[:5]) or 'nothing'}, which is no shape model; "
            "give one written by skinnet, or ICT-FaceKit's."
        )
    try:
        return read(path, arrays)
    except InputError:
        raise
    except (LookupError, ValueError, TypeError) as error:
        raise InputError(f"{path} is no whole shape model ({error!r}); copy it again.") from error


def _own(path: Path, arrays: Mapping[str, Any]) -> ShapeModel:
    if str(arrays[_KEY]) != VERSION:
        raise InputError(
            f"{path} has version {arrays[_KEY]}, and this skinnet reads version {VERSION}; "
            "install the skinnet that made it."
        )
    names, vertices = arrays["landmark_names"].tolist(), arrays["landmark_vertices"].tolist()
    return checked_model(
        _floats(arrays["mean"]),
        _floats(arrays["basis"]),
        _floats(arrays["variances"]),
        arrays["triangles"].astype(np.int64),
        _floats(arrays["uv"]) if "uv" in arrays else None,
        arrays["uv_triangles"].astype(np.int64) if "uv_triangles" in arrays else None,
        dict(zip(names, vertices, strict=True)),
        float(arrays["millimetres"]),
        str(path),
    )


def _floats(array: np.ndarray) -> np.ndarray:
    """In float64, but that a basis kept in float32 to save memory stays so."""
    return array if array.dtype == np.float32 else array.astype(np.float64)
