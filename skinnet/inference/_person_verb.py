"""The verb `person`, with options that are parsed."""

import argparse
import hashlib
import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from skinnet.errors import InputError
from skinnet.files import write_text, write_together
from skinnet.images._mark import Mark, read_mark, read_summary
from skinnet.images._png_file import write_png
from skinnet.images._result_names import OUTPUT, choose_stem, lock_folder
from skinnet.images._walk import Found, Walk, walk
from skinnet.images.resizing import resize
from skinnet.inference._face_choice import check_choice, note_others
from skinnet.inference._input_run import Totals, describe_totals, run_over
from skinnet.inference._messages import note, print_line, report
from skinnet.inference._own_results import Source
from skinnet.inference._person_panel import draw_person
from skinnet.inference._person_shot import PersonShot, describe_shot
from skinnet.inference._photo_verbs import _make_decomposer, _read
from skinnet.inference._tiles import TILE
from skinnet.inference._told_capture import ToldCapture
from skinnet.inference._usual_values import describe_reading
from skinnet.inference.decomposer import Decomposer
from skinnet.inference.person import Person
from skinnet.inference.results import _describe_fault, _make_folder

_ENDS = ".png", ".json"


class _Read(NamedTuple):
    """A shot, its file, and a small picture of what was read of it, uint8 sRGB [h, w, 3]."""

    source: Source
    shot: PersonShot
    picture: NDArray[np.uint8]


def person(options: argparse.Namespace) -> bool:
    """Read shots of one person and fuse them. Returns whether all could be used."""
    _check_faces(options.faces)
    decomposer = _make_decomposer(options)
    found = walk(options.input, options.recursive)
    told = ToldCapture.from_options(options, decomposer, len(found.pictures))
    read, totals = _read_shots(decomposer, found, options, told)
    for sentence in (*found.notes, *(each for one in read for each in one.shot.notes)):
        note(sentence)
    note(describe_totals(totals, found))
    fused = Person._fuse([one.shot for one in read])
    _write(read, fused, options)
    return not totals.failures and None not in fused.sessions


def _check_faces(faces: object) -> None:
    """Refuse several faces of a photograph: which of them is the person is not known."""
    check_choice(faces)
    if faces not in ("largest", 1):
        raise InputError(
            f"person reads the largest face of each photograph; got --faces {faces}. Cut the "
            "person out of photographs in which another face is larger."
        )


def _read_shots(
    decomposer: Decomposer, found: Walk, options: argparse.Namespace, told: ToldCapture
) -> tuple[list[_Read], Totals]:
    """Read every shot; report bad ones and continue."""
    read: dict[str, _Read] = {}

    def read_shot(picture: Found) -> int:
        one = _read_one(decomposer, picture, options, told)
        first = read.setdefault(one.source.digest, one)
        if first is not one:
            note(f"{one.source.name} has the same content as {first.source.name}; it counts once.")
        return int(options.region == "face")

    totals = run_over(found, read_shot, lambda _, error: report(error), options.json)
    return list(read.values()), totals


def _read_one(
    decomposer: Decomposer, found: Found, options: argparse.Namespace, told: ToldCapture
) -> _Read:
    source, picture, notes = _read(found)
    known, told_notes = told.tell(picture)
    (one,) = decomposer(
        picture,
        name=source.name,
        detail=False,
        faces="largest",
        region=options.region,
        capture=known,
    )
    notes = (*notes, *told_notes)
    others = note_others(one.faces_found or 1, 1, source.name)
    if others:
        notes = (*notes, f"{others[0].partition(';')[0]}; the largest one is read.")
    shot = describe_shot(one, source.name)
    if not shot.has_skin:
        raise InputError(f"No skin was found in {source.name}; give a photograph that shows some.")
    kept = tuple(each for each in shot.notes if each not in others)
    return _Read(
        source, shot._replace(notes=(*notes, *kept)), _shrink(picture.srgb[one.box.slices])
    )


def _shrink(picture: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """The picture [h, w, 3] no larger than a tile."""
    height, width = picture.shape[:2]
    scale = min(1.0, TILE / max(height, width))
    return resize(picture, max(1, round(width * scale)), max(1, round(height * scale)))


def _write(read: Sequence[_Read], fused: Person, options: argparse.Namespace) -> None:
    """Write the panel and the summary, both or none, and print what was read."""
    first = read[0].source
    folder = _make_folder(options.output or first.folder / OUTPUT)
    digest = _compute_digest(read)
    with lock_folder(folder):
        stem = choose_stem(
            folder, f"{first.stem}_person", _ENDS, lambda file: _is_own(file, digest)
        )
        summary = _summarise(read, fused, folder, digest)
        try:
            with write_together() as temporary:
                panel = draw_person([one.picture for one in read], fused)
                text = Mark("person", "panel", digest).to_text()
                write_png(temporary(folder / f"{stem}.png"), panel, text)
                record = json.dumps(summary, indent=2, allow_nan=False)
                write_text(temporary(folder / f"{stem}.json"), record + "\n")
        except OSError as error:
            raise _describe_fault(folder, error) from error
    for sentence in fused.notes:
        note(sentence)
    _print(fused, summary, f"{folder / stem}.png and .json", options.json)


def _print(fused: Person, summary: dict[str, Any], files: str, as_json: bool) -> None:
    if as_json:
        print_line(json.dumps(summary, allow_nan=False))
        return
    intervals = fused.interval()
    optics = fused._read[0].model.get("optics")
    numbers = ", ".join(
        describe_reading(name, mean, intervals[name], optics) for name, mean in fused.means.items()
    )
    used = [session for session in fused.sessions if session is not None]
    sessions = f"{max(used)} session{'s' * (max(used) > 1)}"
    print_line(f"{len(used)} shots of {sessions}: {numbers} on skin; 2 files: {files}")


def _summarise(read: Sequence[_Read], fused: Person, folder: Path, digest: str) -> dict[str, Any]:
    """The person's summary, with the files of the shots."""
    summary = fused.summary()
    shots = [
        {"file": shot.pop("name"), "input": one.source.describe(folder), **shot}
        for one, shot in zip(read, summary["shots"], strict=True)
    ]
    return {"digest": digest} | summary | {"shots": shots}


def _compute_digest(read: Sequence[_Read]) -> str:
    """SHA-256 of the shots' digests, whatever their order."""
    digests = sorted(one.source.digest for one in read)
    return hashlib.sha256("".join(digests).encode("ascii")).hexdigest()


def _is_own(file: Path, digest: str) -> bool:
    """Whether a file is an earlier result of the same shots."""
    if file.is_dir():
        return True  # it is not replaced; writing says that it is in the way
    if file.suffix.lower() == ".json":
        return (read_summary(file) or {}).get("digest") == digest
    mark = read_mark(file)
    return mark is not None and mark.verb == "person" and mark.digest == digest
