"""Skins of a hybrid model: their file, and how they are applied to faces."""

from pathlib import Path
from typing import NamedTuple

import numpy as np
import torch
from jaxtyping import Float16

from skinnet.errors import InputError, _explain_fault
from skinnet.files import write_atomically
from skinnet.files._npz import read_npz
from train.synthetic.scene import CHART_SIZE, FaceParameters

MODEL_SKIN_SHARE = 0.5
"""Share of the pictures whose face has a skin of the model, if a model is given."""

_STORED = {"melanin": "melanin", "hemoglobin": "blood"}
"""Names of the arrays in the file."""


class ModelSkins(NamedTuple):
    """Natural logarithms of a pigment over the face's own mean, 0 where nothing is known."""

    melanin: Float16[np.ndarray, "samples rows columns"]
    hemoglobin: Float16[np.ndarray, "samples rows columns"]


def apply_model_skin(
    face: FaceParameters, rng: np.random.Generator, skins: ModelSkins
) -> FaceParameters:
    """Apply one of the skins to a face, mirrored or not, or leave the face as it is.

    Args:
        face: One face, without a batch axis.
        rng: Random numbers.
        skins: One or more skins.

    Returns:
        The face; a share `MODEL_SKIN_SHARE` of all faces gets a skin.
    """
    applied = rng.random() < MODEL_SKIN_SHARE
    number, step = rng.integers(len(skins.melanin)), rng.choice([1, -1])
    charts = (applied * one[number, :, ::step].astype(np.float32) for one in skins)
    melanin, hemoglobin = (torch.from_numpy(np.ascontiguousarray(one)[None]) for one in charts)
    skin = face.skin._replace(
        melanin=face.skin.melanin._replace(model_skin=melanin),
        hemoglobin=face.skin.hemoglobin._replace(model_skin=hemoglobin),
        has_model_skin=torch.tensor(float(applied)),
    )
    return face._replace(skin=skin)


def save_model_skins(path: Path, skins: ModelSkins) -> None:
    """Write skins as .npz, whole or not at all.

    Args:
        path: Ends in .npz.
        skins: One or more skins.

    Raises:
        InputError: If the path ends otherwise or cannot be written.
    """
    if path.suffix != ".npz":
        raise InputError(f"{path} does not end in .npz, as files of skins do.")
    arrays = {_STORED[name]: value for name, value in skins._asdict().items()}
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with write_atomically(path) as part:
            np.savez_compressed(part, **arrays)
    except OSError as error:
        raise InputError(f"{path} cannot be written {_explain_fault(error)}.") from error


def load_model_skins(path: Path) -> ModelSkins:
    """Read skins.

    Args:
        path: As `save_model_skins` writes it.

    Returns:
        The skins.

    Raises:
        InputError: For a file that is missing, damaged or something else.
    """
    try:
        file = read_npz(path)
        skins = ModelSkins(*(file[_STORED[name]] for name in ModelSkins._fields))
    except InputError:
        raise
    except KeyError as error:
        raise InputError(
            f"{path} lacks melanin or blood; make it with python -m train.synthetic.skins."
        ) from error
    except (OSError, ValueError) as error:
        raise InputError(f"{path} cannot be read as an .npz of arrays; make it again.") from error
    for name, charts in skins._asdict().items():
        _check(path, _STORED[name], charts, len(skins.melanin) if skins.melanin.ndim else 0)
    return skins


def _check(path: Path, name: str, charts: np.ndarray, count: int) -> None:
    rows, columns = CHART_SIZE
    if charts.shape != (count, rows, columns) or not count:
        raise InputError(
            f"{path}: {name} is {charts.shape} and should be (skins, {rows}, {columns}); make it "
            "again with this skinnet."
        )
    if not np.issubdtype(charts.dtype, np.floating) or not np.isfinite(charts).all():
        raise InputError(f"{path}: {name} holds values that are not finite numbers; make it again.")
