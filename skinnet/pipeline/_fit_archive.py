"""The archive of a fitted shape: NAME_shape.npz."""

import json
from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from skinnet.appearance._array_file import ARCHIVE_ERRORS
from skinnet.errors import InputError
from skinnet.files import write_atomically
from skinnet.files._npz import read_npz
from skinnet.shape.fit_settings import StageRecord
from skinnet.shape.registration import Registration
from skinnet.shape.similarity import Similarity

_ARRAYS = ("alpha", "vertices", "distances", "kept")


def save_fit(path: Path, fit: Registration, origin: Mapping[str, Any]) -> None:
    """Write a fit and its origin to a .npz file of plain arrays, all of it or nothing."""
    stages = json.dumps([asdict(stage) for stage in fit.record])
    arrays = {name: getattr(fit, name) for name in _ARRAYS}
    with write_atomically(path) as part:
        np.savez(
            part,
            rotation=fit.pose.rotation,
            scale=np.float64(fit.pose.scale),
            translation=fit.pose.translation,
            millimetres=np.float64(fit.millimetres),
            stages=np.array(stages),
            origin=np.array(json.dumps(origin)),
            **arrays,
        )


def load_fit(path: Path) -> Registration:
    """Read a fit; a file that is missing, damaged or of another kind is an `InputError`."""
    try:
        file = read_npz(path)
        pose = Similarity(file["rotation"], float(file["scale"]), file["translation"])
        arrays = {name: file[name] for name in _ARRAYS}
        record = tuple(map(_read_stage, json.loads(str(file["stages"]))))
        millimetres = float(file["millimetres"])
        _check_arrays({"rotation": pose.rotation, "translation": pose.translation, **arrays})
        if not record or not all(0 < each < np.inf for each in (pose.scale, millimetres)):
            raise ValueError("it has no stage, or a scale that is none")
        return Registration(pose, **arrays, millimetres=millimetres, record=record)
    except ARCHIVE_ERRORS as error:
        raise InputError(f"{path} is no fitted shape; make it with skinnet fit-shape.") from error


def _read_stage(stage: dict[str, Any]) -> StageRecord:
    rms = tuple(float(value) for value in stage["rms"])
    counts = int(stage["vertices"]), int(stage["modes"])
    return StageRecord(*counts, rms, bool(stage["converged"]))


def _check_arrays(arrays: Mapping[str, np.ndarray]) -> None:
    """Raise `ValueError` for arrays that are not finite numbers, or do not fit together."""
    count = len(arrays["distances"])
    shapes = {"rotation": (3, 3), "translation": (3,), "alpha": (arrays["alpha"].size,)}
    shapes |= {"vertices": (count, 3), "distances": (count,), "kept": (count,)}
    for name, array in arrays.items():
        kind = "b" if name == "kept" else "f"
        if array.shape != shapes[name] or array.dtype.kind != kind:
            raise ValueError(f"{name} is {list(array.shape)} {array.dtype}")
        if not np.isfinite(array).all():
            raise ValueError(f"{name} has values that are no numbers")
    if not arrays["kept"].any():
        raise ValueError("no vertex was fitted")
