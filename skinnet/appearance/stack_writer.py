"""Writing a stack of subjects: one at a time, and on from where it was interrupted."""

import hashlib
import json
import shutil
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.lib.format import open_memmap

from skinnet.appearance.colour import CHANNELS, SkinColour
from skinnet.appearance.skin_texture import SkinTexture
from skinnet.appearance.stack import (
    FEATURES,
    MASKS,
    STATE,
    SubjectStack,
    is_whole,
    open_stack,
    read_state,
)
from skinnet.errors import InputError
from skinnet.files import write_text

FORMAT = 1
"""Version of the folder's layout."""


def write_stack(
    folder: Path,
    subjects: Mapping[str, Callable[[], SkinTexture]],
    colour: SkinColour,
    inputs: str,
) -> SubjectStack:
    """Write subjects into a folder one after the other, each made when its turn comes.

    Only one is in memory at a time. Interrupted work goes on after the last subject that was
    written, in whose place nothing is made again. `inputs` is anything that changes when a subject
    would: a hash of the files and settings. It guards the folder together with the names, their
    order and `colour`.

    Raises `InputError` if the folder holds a stack of something else, there are fewer than two
    subjects, one has another resolution than those before it, or the disk is too full.
    """
    if len(subjects) < 2:
        raise InputError(f"A model needs at least two subjects; got {len(subjects)}.")
    state: dict[str, Any] = {
        "format": FORMAT,
        "digest": _digest(list(subjects), colour, inputs),
        "names": list(subjects),
        "colour": colour.to_record(),
    }
    folder.mkdir(parents=True, exist_ok=True)
    done, size = _progress(folder, state["digest"])
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
        write_text(folder / STATE, json.dumps(state | {"size": size, "done": index + 1}))
    return open_stack(folder)


def _progress(folder: Path, digest: str) -> tuple[int, int]:
    """How many subjects the folder already holds, and their size; none if its arrays are lost."""
    if not (folder / STATE).exists():
        return 0, 0
    state = read_state(folder)
    if state.get("digest") != digest:
        raise InputError(
            f"{folder} holds subjects, settings or colours other than these; choose another folder "
            "or delete it."
        )
    whole = is_whole(folder, len(state["names"]), state["size"])
    return (state["done"], state["size"]) if whole else (0, 0)


def _allocate(folder: Path, subjects: int, size: int) -> int:
    needed = subjects * size**2 * (4 * len(CHANNELS) + 1)
    # Written to through a memory map, a full disk ends the process without a word.
    if needed > (free := shutil.disk_usage(folder).free):
        raise InputError(
            f"{subjects} subjects of {size} x {size} texels take {needed / 1e9:.1f} GB, and "
            f"{folder} has {free / 1e9:.1f} GB free; choose another disk."
        )
    open_memmap(folder / FEATURES, "w+", np.float32, (subjects, len(CHANNELS), size**2)).flush()
    open_memmap(folder / MASKS, "w+", bool, (subjects, size**2)).flush()
    return size


def _write(folder: Path, index: int, texture: SkinTexture) -> None:
    rows = {FEATURES: texture.features(), MASKS: texture.mask.ravel()}
    for name, row in rows.items():
        array = np.load(folder / name, mmap_mode="r+")
        array[index] = row
        array.flush()


def _digest(names: list[str], colour: SkinColour, inputs: str) -> str:
    text = json.dumps([FORMAT, names, colour.to_record(), inputs])
    return hashlib.sha256(text.encode()).hexdigest()
