"""Files of skins drawn from a hybrid model, and who wears which."""

from pathlib import Path
from typing import NamedTuple
from zipfile import BadZipFile

import numpy as np
from jaxtyping import Float16

from skinnet.errors import InputError
from skinnet.files import write_atomically
from train.synthetic.scene_sampling import CHART, Lot

WORN = 0.5
"""Share of the pictures that wear a skin, where there are any."""


class Skins(NamedTuple):
    """Natural logarithms of a pigment over the face's own mean, 0 where nothing is known."""

    melanin: Float16[np.ndarray, "samples rows columns"]
    blood: Float16[np.ndarray, "samples rows columns"]


def draw_skin(rng: np.random.Generator, skins: Skins) -> Lot:
    """What a lot says of the skin of a hybrid model: none, or one of these, mirrored or not."""
    worn = rng.random() < WORN
    number, turn = rng.integers(len(skins.melanin)), rng.choice([1, -1])
    charts = (worn * one[number, :, ::turn].astype(np.float32) for one in skins)
    melanin, blood = (np.ascontiguousarray(one)[None] for one in charts)
    return {"worn": np.float32(worn), "skin_melanin": melanin, "skin_blood": blood}


def save_skins(path: Path, skins: Skins) -> None:
    """Write skins as .npz, whole or not at all."""
    if path.suffix != ".npz":
        raise InputError(f"{path} does not end in .npz, as files of skins do.")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with write_atomically(path) as part:
            np.savez_compressed(part, **skins._asdict())
    except OSError as error:
        raise InputError(f"{path} cannot be written ({error.strerror}); check the path.") from error


def load_skins(path: Path) -> Skins:
    """Read skins; raises `InputError` for a file that is missing, damaged or something else."""
    try:
        with path.open("rb") as stream, np.load(stream, allow_pickle=False) as file:
            skins = Skins(*(file[name] for name in Skins._fields))
    except KeyError as error:
        raise InputError(
            f"{path} lacks melanin or blood; make it with python -m train.synthetic.skins."
        ) from error
    except (OSError, ValueError, EOFError, TypeError, AttributeError, BadZipFile) as error:
        raise InputError(f"{path} cannot be read as an .npz of arrays; make it again.") from error
    for name, charts in skins._asdict().items():
        _check(path, name, charts, len(skins.melanin) if skins.melanin.ndim else 0)
    return skins


def _check(path: Path, name: str, charts: np.ndarray, count: int) -> None:
    if charts.shape != (count, *CHART) or not count:
        raise InputError(
            f"{path}: {name} is {charts.shape} and should be (skins, {CHART[0]}, {CHART[1]}); make "
            "it again with this skinnet."
        )
    if not np.issubdtype(charts.dtype, np.floating) or not np.isfinite(charts).all():
        raise InputError(f"{path}: {name} holds what is no finite number; make it again.")
