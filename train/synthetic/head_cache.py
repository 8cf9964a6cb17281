"""Casts of many heads, kept on disk and built only where they are missing."""

import hashlib
import json
import sys
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from functools import cache
from multiprocessing import get_context
from pathlib import Path
from zipfile import BadZipFile

import numpy as np

from skinnet.files import make_folder, write_atomically
from train.synthetic.head_cast import Buffers, cast
from train.synthetic.heads import ict_head, procedural_head
from train.synthetic.ict_model import IctHead, load_ict_head

VERSION = 1
"""Raise it with every change to what heads or their casts are; older files are then built anew."""

SPLITS = {"train": 0, "val": 1, "test": 2}
ICT_SHARE = 0.7


@dataclass(frozen=True)
class Settings:
    """What decides about a head's cast, apart from its split and number."""

    size: int
    seed: int
    kind: str
    version: int

    @property
    def key(self) -> str:
        return f"v{self.version}-{self.size}px-seed{self.seed}-{self.kind}"


def geometry(
    folder: Path,
    size: int,
    count: int,
    split: str,
    seed: int,
    ict: Path | None = None,
    workers: int = 1,
) -> Buffers:
    """Casts of `count` heads, stacked; train, val and test never share a head.

    Each lies in `folder` in a file of its own, so that a build that was cut short goes on where it
    was. With the file `ict` of ICT-FaceKit most heads are of it, otherwise all are procedural.
    """
    settings = Settings(size, seed, "procedural" if ict is None else _fingerprint(ict), VERSION)
    place = make_folder(folder / settings.key, "give another folder for the geometry")
    stack = _empty(count, size)
    missing = [i for i in range(count) if not _fill(stack, i, _file(place, split, i), settings)]
    jobs = [(place, settings, split, index, ict) for index in missing]
    if jobs and ict is None:
        _say("Without the file of ICT-FaceKit all heads are procedural.\n")
    for done, index in enumerate(_built(jobs, workers), 1):
        _say(f"\rHeads of {split}: {done:,} of {len(jobs):,} cast.")
        assert _fill(stack, index, _file(place, split, index), settings)
    _say("\n" if jobs else "")
    return stack


Job = tuple[Path, Settings, str, int, Path | None]


def _built(jobs: list[Job], workers: int) -> Iterator[int]:
    if min(workers, len(jobs)) < 2:
        yield from map(_build, jobs)
        return
    # Threads that Embree and torch hold do not survive a fork.
    with get_context("spawn").Pool(min(workers, len(jobs))) as pool:
        yield from pool.imap_unordered(_build, jobs)


def _build(job: Job) -> int:
    place, settings, split, index, ict = job
    draw = np.random.default_rng([settings.seed, SPLITS[split], index])
    if ict is not None and draw.random() < ICT_SHARE:
        head = ict_head(_model(ict), draw)
    else:
        head = procedural_head(draw)
    _write(_file(place, split, index), cast(head, draw, settings.size), settings)
    return index


@cache
def _model(path: Path) -> IctHead:
    return load_ict_head(path)


@cache
def _fingerprint(path: Path) -> str:
    load_ict_head(path)
    return "ict" + hashlib.sha256(path.read_bytes()).hexdigest()[:8]


def _file(place: Path, split: str, index: int) -> Path:
    return place / f"{split}_{index:05d}.npz"


def _write(path: Path, cast_: Buffers, settings: Settings) -> None:
    with write_atomically(path) as part:
        np.savez(part, settings=json.dumps(asdict(settings)), **cast_._asdict())


def _fill(stack: Buffers, index: int, path: Path, settings: Settings) -> bool:
    """Whether a file holds the cast asked for, which is then copied into the stack."""
    try:
        with path.open("rb") as stream, np.load(stream, allow_pickle=False) as file:
            if json.loads(str(file["settings"])) != asdict(settings):
                return False
            arrays = [file[name] for name in Buffers._fields]
    except (OSError, ValueError, KeyError, EOFError, TypeError, BadZipFile):
        return False
    for whole, one in zip(stack, arrays, strict=True):
        if whole.shape[1:] != one.shape or whole.dtype != one.dtype:
            return False
    for whole, one in zip(stack, arrays, strict=True):
        whole[index] = one
    return True


def _empty(count: int, size: int) -> Buffers:
    square = (count, size, size)
    return Buffers(
        np.zeros(square, np.uint8),
        np.zeros((*square, 3), np.int8),
        np.zeros((*square, 2), np.float16),
        np.zeros(square, np.uint8),
        np.zeros(square, np.uint64),
    )


def _say(text: str) -> None:
    sys.stderr.write(text)
    sys.stderr.flush()
