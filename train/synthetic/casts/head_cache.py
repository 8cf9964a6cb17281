"""Casts of many heads, kept on disk and made only where they are missing."""

import hashlib
import json
import sys
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from functools import cache, partial
from multiprocessing import get_context
from pathlib import Path

import numpy as np

from skinnet.files import make_folder, write_atomically
from skinnet.files._npz import read_npz
from train.synthetic.bodies.ict_model import IctModel, read_ict_model
from train.synthetic.bodies.labelled_mesh import LabelledMesh
from train.synthetic.casts.any_cast import cast_any
from train.synthetic.casts.head_cast import HeadCast, cast_head
from train.synthetic.subjects.heads import make_ict_head, make_procedural_head
from train.synthetic.variety import Variety

VERSION = 1
"""Raise it with every change to mild heads or their casts; older files are then not used."""

ANY_VERSION = 2
"""The same for the variety `any`."""

SPLITS = {"train": 0, "val": 1, "test": 2}
_ICT_SHARE = 0.7

_STORED = {
    "label": "label",
    "normal": "normal",
    "chart": "chart",
    "sky_visibility": "openness",
    "visibility_mask": "seen",
}
"""Names of the arrays in the files, two of which are older than the names in the code."""


@dataclass(frozen=True)
class CastSettings:
    """All that a head's cast depends on, apart from its split and number."""

    size: int
    seed: int
    kind: str
    version: int

    @property
    def folder(self) -> str:
        """Name of the folder of such casts."""
        return f"v{self.version}-{self.size}px-seed{self.seed}-{self.kind}"


def load_or_cast_heads(
    folder: Path,
    size: int,
    count: int,
    split: str,
    seed: int,
    ict: Path | None = None,
    workers: int = 1,
    variety: Variety = "mild",
) -> HeadCast:
    """Load the casts of heads, and cast those that are missing.

    Each cast has a file of its own, so that work that was interrupted goes on where it was.

    Args:
        folder: Where the casts are kept.
        size: Side of the pictures in pixels.
        count: Number of heads.
        split: Train, val or test, which never share a head.
        seed: Seed of the heads.
        ict: File of ICT-FaceKit, of which most heads are then made; all others are procedural.
        workers: Processes that cast heads.
        variety: Which kind of faces.

    Returns:
        The casts, stacked.

    Raises:
        InputError: If the folder cannot be made, or `ict` cannot be read.
    """
    settings = _describe(size, seed, ict, variety)
    place = make_folder(folder / settings.folder, "give another folder for the geometry")
    stack = _make_empty_stack(count, size)
    missing = [
        i for i in range(count) if not _load(stack, i, _name_file(place, split, i), settings)
    ]
    jobs = [(place, settings, split, index, ict, variety) for index in missing]
    if jobs and ict is None:
        _report("Without the file of ICT-FaceKit all heads are procedural.\n")
    for done, index in enumerate(_run(jobs, workers), 1):
        _report(f"\rHeads of {split}: {done:,} of {len(jobs):,} cast.")
        assert _load(stack, index, _name_file(place, split, index), settings)
    _report("\n" if jobs else "")
    return stack


def _describe(size: int, seed: int, ict: Path | None, variety: Variety) -> CastSettings:
    kind = "procedural" if ict is None else _identify(ict)
    if variety == "mild":
        return CastSettings(size, seed, kind, VERSION)
    return CastSettings(size, seed, f"{variety}-{kind}", ANY_VERSION)


_Job = tuple[Path, CastSettings, str, int, Path | None, Variety]


def _run(jobs: list[_Job], workers: int) -> Iterator[int]:
    if min(workers, len(jobs)) < 2:
        yield from map(_cast, jobs)
        return
    # Threads that Embree and torch hold do not survive a fork.
    with get_context("spawn").Pool(min(workers, len(jobs))) as pool:
        yield from pool.imap_unordered(_cast, jobs)


def _cast(job: _Job) -> int:
    place, settings, split, index, ict, variety = job
    rng = np.random.default_rng([settings.seed, SPLITS[split], index])
    make_head = partial(_make_head, ict=ict, variety=variety)
    cast = (
        cast_head(make_head(rng), rng, settings.size)
        if variety == "mild"
        else cast_any(make_head, rng, settings.size)
    )
    _write(_name_file(place, split, index), cast, settings)
    return index


def _make_head(rng: np.random.Generator, ict: Path | None, variety: Variety) -> LabelledMesh:
    if ict is not None and rng.random() < _ICT_SHARE:
        return make_ict_head(_read_model(ict), rng, variety)
    return make_procedural_head(rng, variety)


@cache
def _read_model(path: Path) -> IctModel:
    return read_ict_model(path)


@cache
def _identify(path: Path) -> str:
    read_ict_model(path)
    return "ict" + hashlib.sha256(path.read_bytes()).hexdigest()[:8]


def _name_file(place: Path, split: str, index: int) -> Path:
    return place / f"{split}_{index:05d}.npz"


def _write(path: Path, cast: HeadCast, settings: CastSettings) -> None:
    arrays = {_STORED[name]: value for name, value in cast._asdict().items()}
    with write_atomically(path) as part:
        np.savez(part, settings=json.dumps(asdict(settings)), **arrays)


def _load(stack: HeadCast, index: int, path: Path, settings: CastSettings) -> bool:
    """Copy a cast into the stack, if the file holds the one that is asked for."""
    try:
        file = read_npz(path)
        if json.loads(str(file["settings"])) != asdict(settings):
            return False
        arrays = [file[_STORED[name]] for name in HeadCast._fields]
    except (OSError, ValueError, KeyError):
        return False
    for whole, one in zip(stack, arrays, strict=True):
        if whole.shape[1:] != one.shape or whole.dtype != one.dtype:
            return False
    for whole, one in zip(stack, arrays, strict=True):
        whole[index] = one
    return True


def _make_empty_stack(count: int, size: int) -> HeadCast:
    square = (count, size, size)
    return HeadCast(
        np.zeros(square, np.uint8),
        np.zeros((*square, 3), np.int8),
        np.zeros((*square, 2), np.float16),
        np.zeros(square, np.uint8),
        np.zeros(square, np.uint64),
    )


def _report(text: str) -> None:
    sys.stderr.write(text)
    sys.stderr.flush()
