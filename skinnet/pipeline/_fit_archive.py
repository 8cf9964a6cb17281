"""The archive of a fitted shape: NAME_shape.npz."""

import json
from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from skinnet.appearance._model_arrays import ARCHIVE_ERRORS
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
        stages = json.loads(str(file["stages"]))
        record = tuple(StageRecord(**{**one, "rms": tuple(one["rms"])}) for one in stages)
        return Registration(pose, **arrays, millimetres=float(file["millimetres"]), record=record)
    except ARCHIVE_ERRORS as error:
        raise InputError(f"{path} is no fitted shape; make it with skinnet fit-shape.") from error
