"""Writer of the stack of subjects: one subject at a time; an interrupted run is resumed."""

import hashlib
import json
import shutil
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from skinnet._version import __version__
from skinnet.appearance.colour import CHANNELS, SkinColour
from skinnet.appearance.skin_texture import SkinTexture
from skinnet.appearance.stack import (
    _FEATURES,
    _MASKS,
    _STACK_FORMAT,
    _STATE,
    SubjectStack,
    _is_whole,
    _read_state,
    open_stack,
)
from skinnet.errors import InputError
from skinnet.files import write_text
from skinnet.files._npz import allocate_npy, map_npy


def write_stack(
    folder: Path,
    subjects: Mapping[str, Callable[[], SkinTexture]],
    colour: SkinColour,
    inputs: str,
) -> SubjectStack:
    """Write subjects into a folder one by one, so that only one is in memory at a time.

    If an earlier run was interrupted, this one resumes after the last subject that was written.

    Args:
        folder: Where the stack goes; made if needed.
        subjects: For each name a function that makes or reads the texture.
        colour: Light, camera and calibration under which all subjects were inverted.
        inputs: Any text that changes when a subject would change, such as a hash of files and
            settings. A stack with other inputs, names or colour is not written over.

    Returns:
        The finished stack.

    Raises:
        InputError: If the folder holds another stack or other files, there are fewer than two
            subjects, their resolutions differ, or the disk is too full.

    Example:
        >>> import tempfile
        >>> def make(level: float) -> SkinTexture:
        ...     known = np.ones((2, 2), bool)
        ...     fraction = np.full((2, 2), level, np.float32)
        ...     return SkinTexture(fraction, fraction, np.zeros((2, 2, 3), np.float32), known)
        >>> subjects = {"pale": lambda: make(0.02), "dark": lambda: make(0.1)}
        >>> with tempfile.TemporaryDirectory() as folder:
        ...     stack = write_stack(Path(folder), subjects, SkinColour(nodes=(4, 4)), "two levels")
        ...     names, blood = stack.names, open_stack(Path(folder)).texture(1).f_blood[0, 0]
        >>> names, round(float(blood), 3)
        (('pale', 'dark'), 0.1)
    """
    if len(subjects) < 2:
        raise InputError(f"A model needs at least two subjects; got {len(subjects)}.")
    state: dict[str, Any] = {
        "format": _STACK_FORMAT,
        "skinnet": __version__,
        "digest": _compute_digest(list(subjects), colour, inputs),
        "names": list(subjects),
        "colour": colour.to_record(),
    }
    folder.mkdir(parents=True, exist_ok=True)
    _check_names(folder)
    done, size = _read_progress(folder, state["digest"])
    for index, (name, make) in enumerate(subjects.items()):
        if index < done:
            continue
        texture = make()
        if index == 0:
            size = _allocate(folder, len(subjects), len(texture.mask))
        if len(texture.mask) != size:
            raise InputError(
                f"{name} has {len(texture.mask)} texels a side and the subjects before it {size}; "
                "warp all to one resolution."
            )
        _write(folder, index, texture)
        write_text(folder / _STATE, json.dumps(state | {"size": size, "done": index + 1}))
    return open_stack(folder)


def _check_names(folder: Path) -> None:
    """Refuse a folder of other files: a stack is removed as a whole when it is not needed."""
    names = sorted(file.name for file in folder.iterdir() if not file.name.startswith("."))
    others = [name for name in names if name not in (_FEATURES, _MASKS, _STATE)]
    if others:
        raise InputError(
            f"{folder} holds other files ({', '.join(others[:3])}); choose another folder."
        )


def _read_progress(folder: Path, digest: str) -> tuple[int, int]:
    """Read the number of subjects in the folder and their size; 0 if its arrays are damaged."""
    if not (folder / _STATE).exists():
        return 0, 0
    state = _read_state(folder)
    if state.get("digest") != digest:
        raise InputError(
            f"{folder} holds a stack of other subjects, settings or colours; choose another folder "
            "or delete this one."
        )
    whole = _is_whole(folder, len(state["names"]), state["size"])
    return (state["done"], state["size"]) if whole else (0, 0)


def _allocate(folder: Path, subjects: int, size: int) -> int:
    needed = subjects * size**2 * (4 * len(CHANNELS) + 1)
    if needed > (free := shutil.disk_usage(folder).free):
        raise InputError(
            f"{subjects} subjects of {size} x {size} texels take {needed / 1e9:.1f} GB, and "
            f"{folder} has {free / 1e9:.1f} GB free; choose another disk."
        )
    allocate_npy(folder / _FEATURES, np.float32, (subjects, len(CHANNELS), size**2))
    allocate_npy(folder / _MASKS, bool, (subjects, size**2))
    return size


def _write(folder: Path, index: int, texture: SkinTexture) -> None:
    rows = {_FEATURES: texture.features(), _MASKS: texture.mask.ravel()}
    for name, row in rows.items():
        array = map_npy(folder / name, writable=True)
        array[index] = row
        array.flush()  # type: ignore[attr-defined]


def _compute_digest(names: list[str], colour: SkinColour, inputs: str) -> str:
    text = json.dumps([_STACK_FORMAT, names, colour.to_record(), inputs])
    return hashlib.sha256(text.encode()).hexdigest()
