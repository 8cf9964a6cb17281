"""The verb `compare`, with options that are parsed."""

import argparse
import json
from pathlib import Path
from typing import Any

from skinnet.errors import InputError
from skinnet.files import READ_ERRORS, write_text, write_together
from skinnet.files._reading import MOST_TEXT, read_file
from skinnet.images._mark import EDITED, Mark, read_mark
from skinnet.images._png_file import write_png
from skinnet.images._result_names import OUTPUT, choose_stem, lock_folder
from skinnet.images._walk import STDIN, find_one
from skinnet.images.faces._face_models import open_ahead
from skinnet.inference._comparison.picture import describe_change
from skinnet.inference._messages import note, print_line
from skinnet.inference._own_results import Source
from skinnet.inference._photo_verbs import _read
from skinnet.inference._told_capture import ToldCapture
from skinnet.inference._uncertainty import PIGMENTS
from skinnet.inference.comparison import Comparison, compare_photographs
from skinnet.inference.decomposer import Decomposer
from skinnet.inference.results import _describe_fault, _make_folder

_PART = "comparison"
"""Part of the mark of the picture, and how its name ends."""


def compare(options: argparse.Namespace) -> None:
    """Compare two photographs of one face, and write a picture and a summary."""
    if options.before == options.after == STDIN:
        raise InputError("Standard input has one photograph; give the file of the other one.")
    open_ahead()
    decomposer = Decomposer(options.model, providers=options.provider)
    decomposer.load()
    told = ToldCapture.from_options(options, decomposer, 2)
    read = [_read(find_one(path)) for path in (options.before, options.after)]
    (before, first, _), (after, second, _) = read
    (known, first_notes), (other_known, second_notes) = told.tell(first), told.tell(second)
    found = compare_photographs(
        first,
        second,
        decomposer=decomposer,
        before_capture=known,
        after_capture=other_known,
        names=(before.name, after.name),
    )
    notes = [each for _, _, notes in read for each in notes]
    notes += [*first_notes, *second_notes, *_note_own_edit(before, after), *found.notes]
    folder = _make_folder(options.output or before.folder / OUTPUT)
    stem, summary = _write(folder, (before, after), found, notes)
    for sentence in summary["notes"]:
        note(sentence)
    if options.json:
        print_line(json.dumps(summary, allow_nan=False))
    else:
        print_line(f"{_describe(found)}; 2 files: {folder / stem}.png and {folder / stem}.json")


def _note_own_edit(*sources: Source) -> list[str]:
    """Note that one of two photographs is an edit of the other."""
    for photo, other in (sources, sources[::-1]):
        mark = None if other.path is None else read_mark(other.path)
        if mark is not None and mark.part == EDITED and mark.digest == photo.digest:
            return [
                f"{other.name} is an edit of {photo.name} by skinnet. Whether skin or light has "
                "changed over a whole face is as uncertain as for any two photographs, so that "
                "the edit may be called unchanged; skinnet edit --json prints what it has changed."
            ]
    return []


def _write(
    folder: Path, sources: tuple[Source, Source], found: Comparison, notes: list[str]
) -> tuple[str, dict[str, Any]]:
    """Write both files under a name that is free or their own. Returns it, and the summary."""
    digests = [source.digest for source in sources]
    wanted = f"{sources[0].stem}_{sources[1].stem}_{_PART}"
    inputs = [source.describe(folder) for source in sources]
    summary = {"inputs": inputs} | found.summary()
    summary["notes"] = list(dict.fromkeys(notes))
    with lock_folder(folder):
        ends = (".png", ".json")
        stem = choose_stem(folder, wanted, ends, lambda file: _belongs(file, digests))
        try:
            with write_together() as temporary:
                mark = Mark("compare", _PART, digests[0])
                write_png(temporary(folder / f"{stem}.png"), found.draw(), mark.to_text())
                text = json.dumps(summary, indent=2, allow_nan=False)
                write_text(temporary(folder / f"{stem}.json"), text + "\n")
        except OSError as error:
            raise _describe_fault(folder, error) from error
    return stem, summary


def _belongs(file: Path, digests: list[str]) -> bool:
    """Whether a file is an earlier comparison of the same photographs."""
    if file.suffix == ".png":
        mark = read_mark(file)
        return mark is not None and mark.part == _PART and mark.digest == digests[0]
    try:
        inputs = json.loads(read_file(file, MOST_TEXT))["inputs"]
        return [each["sha256"] for each in inputs] == digests
    except (*READ_ERRORS, KeyError, TypeError):
        return False


def _describe(found: Comparison) -> str:
    parts = (f"{name} {describe_change(getattr(found.face, name))}" for name in PIGMENTS)
    verdict = " (unchanged)" if found.face.unchanged else ""
    return f"{found.names[0]} to {found.names[1]}: {', '.join(parts)}{verdict}"
