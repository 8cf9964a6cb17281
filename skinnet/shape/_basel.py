"""The Basel Face Models of 2009, 2017 and 2019.

Their licence forbids copies, so the loaders follow the published layout and are tested on files of
that layout, not on the models themselves.
"""

import json
import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import h5py
import numpy as np
from jaxtyping import Float, Int
from scipy.io import loadmat, whosmat
from scipy.io.matlab import MatReadError
from scipy.spatial import cKDTree

from skinnet.errors import InputError, _name_error
from skinnet.files import READ_ERRORS
from skinnet.files._npz import check_size
from skinnet.mesh._orientation import is_inside_out
from skinnet.shape._model_numbers import to_floats, to_indices
from skinnet.shape.model import ShapeModel

_LANDMARKS = {
    "right_brow_inner": "right.eyebrow.inner_lower",
    "left_brow_inner": "left.eyebrow.inner_lower",
    "nose_tip": "center.nose.tip",
    "right_nostril": "right.nose.wing.tip",
    "nose_base": "center.nose.attachement_to_philtrum",
    "left_nostril": "left.nose.wing.tip",
    "right_eye_outer": "right.eye.corner_outer",
    "right_eye_inner": "right.eye.corner_inner",
    "left_eye_inner": "left.eye.corner_inner",
    "left_eye_outer": "left.eye.corner_outer",
    "mouth_right": "right.lips.corner",
    "mouth_top": "center.lips.upper.outer",
    "mouth_left": "left.lips.corner",
    "mouth_bottom": "center.lips.lower.outer",
    "lips_upper": "center.lips.upper.inner",
    "lips_lower": "center.lips.lower.inner",
    "chin": "center.chin.tip",
}


def load_basel_2009(path: Path) -> ShapeModel:
    """Load 01_MorphableModel.mat (Paysan et al. 2009): micrometres, 53,490 vertices, 199 modes.

    `shapeMU` [3N, 1] is the mean, `shapePC` [3N, S] holds unit columns, `shapeEV` [S, 1] standard
    deviations, and `tl` [T, 3] vertices counted from one. The file has no landmarks. Raises
    `InputError` for another layout.
    """
    names = ("shapeMU", "shapePC", "shapeEV", "tl")
    try:
        check_size(path, sum(8 * math.prod(shape) for _, shape, _ in whosmat(path)))
        arrays = loadmat(path, variable_names=names)
        mean, modes, deviations = (to_floats(arrays[name]) for name in names[:3])
        triangles = to_indices(arrays["tl"]) - 1
    except InputError:
        raise
    except (MatReadError, *READ_ERRORS) as error:
        raise InputError(
            f"{path} is not a Basel Face Model of 2009, whose .mat holds {', '.join(names)} "
            f"({_name_error(error)}); give 01_MorphableModel.mat."
        ) from error
    with np.errstate(over="ignore"):
        variances = np.square(deviations.astype(np.float64).ravel())
    return _build_model(path, mean, modes, variances, triangles, {}, 1e-3)


def load_basel_2017(path: Path) -> ShapeModel:
    """Load an .h5 of the models of 2017 or 2019 (Gerig et al. 2018): the neutral shape, in mm.

    The layout is Statismo's: `shape/model/mean` [3N], `pcaBasis` [3N, S], `pcaVariance` [S] and
    `shape/representer/cells` [3, T]. `metadata/landmarks/json` names points, which give 17 of the
    20 landmarks of a fit, at the nearest vertices of the mean. The bridge of the nose and the outer
    ends of the brows are missing. Raises `InputError` for another layout.
    """
    try:
        with h5py.File(path, "r") as file:
            check_size(path, _count_bytes(file))
            mean, modes, variances = (
                to_floats(file[f"shape/model/{name}"])
                for name in ("mean", "pcaBasis", "pcaVariance")
            )
            cells = to_indices(file["shape/representer/cells"])
            points = _read_landmarks(file)
    except InputError:
        raise
    except READ_ERRORS as error:
        raise InputError(
            f"{path} is not a Basel Face Model of 2017 or 2019, whose .h5 holds shape/model/mean, "
            f"pcaBasis, pcaVariance and shape/representer/cells ({_name_error(error)})."
        ) from error
    triangles = cells.T if cells.shape[:1] == (3,) else cells
    with np.errstate(invalid="ignore"):
        variances = variances.astype(np.float64).ravel()
    return _build_model(path, mean, modes, variances, triangles, points, 1.0)


def _count_bytes(file: h5py.File) -> int:
    """Count the bytes of the arrays that are read, as they are unpacked."""
    names = ("model/mean", "model/pcaBasis", "model/pcaVariance", "representer/cells")
    return sum(file[f"shape/{name}"].nbytes for name in names)


def _build_model(
    path: Path,
    mean: np.ndarray,
    modes: np.ndarray,
    variances: Float[np.ndarray, "modes"],
    triangles: Int[np.ndarray, "..."],
    points: dict[str, list[float]],
    millimetres: float,
) -> ShapeModel:
    fits = modes.ndim == 2 and modes.size and len(modes) == mean.size and mean.size % 3 == 0
    if not fits:
        raise InputError(
            f"{path} is not a usable shape model: its mean has {mean.size:,} numbers and "
            f"its basis is {list(modes.shape)}."
        )
    basis = np.ascontiguousarray(modes.T, np.float64)
    # Statismo before 0.9 multiplied the columns by the standard deviations.
    with np.errstate(invalid="ignore", over="ignore"):
        basis /= np.maximum(np.linalg.norm(basis, axis=1, keepdims=True), 1e-300)
    model = ShapeModel.from_arrays(
        mean.astype(np.float64).reshape(-1, 3),
        basis.reshape(len(basis), -1, 3),
        variances,
        np.ascontiguousarray(triangles),
        millimetres=millimetres,
        name=str(path),
    )
    return _complete(model, points)


def _complete(model: ShapeModel, points: dict[str, list[float]]) -> ShapeModel:
    """Add landmarks, and make triangles counter-clockwise: those of 2009 are clockwise."""
    tree = cKDTree(model.mean)
    landmarks = {
        name: int(tree.query(points[key])[1]) for name, key in _LANDMARKS.items() if key in points
    }
    order = [0, 2, 1] if is_inside_out(model.mean, model.triangles) else [0, 1, 2]
    return replace(model, landmarks=landmarks, triangles=model.triangles[:, order])


def _read_landmarks(file: Any) -> dict[str, list[float]]:
    if "metadata/landmarks/json" not in file:
        return {}
    stored = file["metadata/landmarks/json"][()]
    text = stored if isinstance(stored, bytes | str) else np.asarray(stored).tobytes()
    return {point["id"]: point["coordinates"] for point in json.loads(text)}
