"""Files of shape models: skinnet's own .npz, ICT-FaceKit, Basel Face Models, meshes."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from skinnet.errors import InputError, _clip, _name_error
from skinnet.files import READ_ERRORS, write_atomically
from skinnet.files._content import explain_format
from skinnet.files._npz import read_npz
from skinnet.mesh._mesh_parts import MESH_SUFFIXES
from skinnet.shape._basel import load_basel_2009, load_basel_2017
from skinnet.shape._default_model import build_default_model
from skinnet.shape._ict import NEUTRAL, load_ict_folder, read_ict_arrays
from skinnet.shape._landmark_vertices import read_landmark_vertices
from skinnet.shape._model_numbers import to_floats, to_indices
from skinnet.shape._registered_files import load_registered_meshes
from skinnet.shape.model import ShapeModel

VERSION = "1"
"""Version of skinnet's own layout, stored under `_KEY`."""

_KEY = "skinnet_shape_model"


def load_shape_model(
    path: Path | None = None,
    landmarks: Path | None = None,
    modes: int | None = None,
    align: bool = True,
    millimetres: float | None = None,
) -> ShapeModel:
    """Load a shape model from a file or folder of any known layout.

    Known are skinnet's own .npz (`save_shape_model`), ICT-FaceKit (its .npz, its folder FaceXModel
    or the folder above), the Basel Face Models of 2009 (.mat), 2017 and 2019 (.h5), and a folder of
    registered meshes, of which `build_shape_model` builds a model. Nothing is unpickled.

    Args:
        path: The file or folder; None for the procedural face, which is part of skinnet.
        landmarks: A .json file of names and vertex numbers that replaces the model's own landmarks.
        modes: Keep only that many modes; None for all.
        align: For a folder of meshes: see `build_shape_model`.
        millimetres: For a folder of meshes: length of their unit in mm, guessed if None.

    Returns:
        The model.

    Raises:
        InputError: If there is no model at `path`, or it is damaged.

    Example:
        >>> from skinnet.shape import load_shape_model
        >>> model = load_shape_model(modes=10)
        >>> model.name, model.basis.shape
        ('the procedural face', (10, 5950, 3))
    """
    model = build_default_model() if path is None else _load_path(Path(path), align, millimetres)
    if landmarks is not None:
        vertices = read_landmark_vertices(Path(landmarks), len(model.mean))
        model = replace(model, landmarks=vertices)
    return model if modes is None else model.truncate(modes)


def save_shape_model(path: Path, model: ShapeModel) -> None:
    """Write a model as .npz. If writing fails, no file is left.

    Args:
        path: The file, with the suffix .npz.
        model: The model.

    Raises:
        InputError: If `path` has another suffix.

    Example:
        >>> from pathlib import Path
        >>> import numpy as np
        >>> from skinnet.shape import ShapeModel, load_shape_model, save_shape_model
        >>> triangle = np.array([[0, 1, 2]])
        >>> model = ShapeModel(np.eye(3), np.ones((2, 3, 3)), np.ones(2), triangle)
        >>> save_shape_model(Path("small.npz"), model)
        >>> load_shape_model(Path("small.npz")).basis.shape
        (2, 3, 3)
    """
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


def _load_path(path: Path, align: bool, millimetres: float | None) -> ShapeModel:
    if path.is_dir():
        return _load_folder(path, align, millimetres)
    if not path.is_file():
        raise InputError(f"There is no shape model {path}; check the path.")
    loaders: Mapping[str, Callable[[Path], ShapeModel]] = {
        ".npz": _load_npz,
        ".mat": load_basel_2009,
        ".h5": load_basel_2017,
        ".hdf5": load_basel_2017,
    }
    load = loaders.get(path.suffix.lower())
    if load is None:
        raise InputError(
            f"{path} is not a shape model; give {', '.join(loaders)}, ICT-FaceKit's folder or a "
            "folder of registered meshes."
        )
    return load(path)


def _load_folder(folder: Path, align: bool, millimetres: float | None) -> ShapeModel:
    for inner in (folder, folder / "FaceXModel"):
        if (inner / NEUTRAL).is_file():
            return load_ict_folder(inner)
    files = sorted(each for each in folder.iterdir() if each.suffix.lower() in MESH_SUFFIXES)
    return load_registered_meshes(files, align, millimetres, str(folder))


def _load_npz(path: Path) -> ShapeModel:
    try:
        arrays = {
            name: array for name, array in read_npz(path).items() if not name.startswith("expr_")
        }
    except InputError:
        raise
    except READ_ERRORS as error:
        raise InputError(
            f"{path} is not an .npz of plain arrays, or is cut short ({error}); copy it again."
        ) from error
    read: Callable[[Path, Mapping[str, Any]], ShapeModel] | None
    read = _read_own if _KEY in arrays else read_ict_arrays if "id_modes" in arrays else None
    if read is None:
        raise InputError(
            f"{path} holds {', '.join(list(arrays)[:5]) or 'nothing'}, which is not a shape model; "
            "give one written by skinnet, or ICT-FaceKit's."
        )
    try:
        return read(path, arrays)
    except InputError:
        raise
    except (LookupError, ValueError, TypeError) as error:
        raise InputError(
            f"{path} is not a complete shape model ({_name_error(error)}); copy it again."
        ) from error


def _read_own(path: Path, arrays: Mapping[str, Any]) -> ShapeModel:
    if str(arrays[_KEY]) != VERSION:
        raise InputError(
            f"{path} has version {_clip(arrays[_KEY])}, and this skinnet reads version {VERSION}; "
            "make it again with this version, or use the one that wrote it "
            f"({explain_format(arrays[_KEY], int(VERSION), None)})."
        )
    names, vertices = (
        arrays["landmark_names"].tolist(),
        to_indices(arrays["landmark_vertices"]).tolist(),
    )
    return ShapeModel.from_arrays(
        to_floats(arrays["mean"]),
        to_floats(arrays["basis"]),
        to_floats(arrays["variances"]),
        to_indices(arrays["triangles"]),
        to_floats(arrays["uv"]) if "uv" in arrays else None,
        to_indices(arrays["uv_triangles"]) if "uv_triangles" in arrays else None,
        dict(zip(names, vertices, strict=True)),
        float(arrays["millimetres"]),
        str(path),
    )
