"""The verb `edit`, with options that are parsed."""

import argparse
import json
import os
import sys
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from numpy.typing import NDArray

from skinnet._version import __version__
from skinnet.errors import InputError
from skinnet.images._kind import Kind
from skinnet.images._mark import EDITED, Mark
from skinnet.images._walk import Found, PassedOver, Walk, walk
from skinnet.images._write import check_quality, find_format, write_picture
from skinnet.inference._blood_state import check_state
from skinnet.inference._edit_mask import read_edit_mask
from skinnet.inference._edit_place import STANDARD_OUTPUT, EditPlace, Output
from skinnet.inference._edited import Edited
from skinnet.inference._face_choice import check_choice
from skinnet.inference._input_run import NotWrittenError, describe_totals, is_one_file, run_over
from skinnet.inference._messages import explain, note, print_line, report
from skinnet.inference._own_results import Source
from skinnet.inference._photo_verbs import _keep_names, _open_networks, _prepare, _read
from skinnet.inference._pigment_edit import check_factors
from skinnet.inference._told_capture import ToldCapture
from skinnet.inference.decomposer import Decomposer

_MASK = Kind("a mask of the edit", "masks of the edit", "give photographs")


@dataclass(frozen=True)
class _EditRun:
    """What all edits of a run share."""

    decomposer: Decomposer
    options: argparse.Namespace
    told: ToldCapture
    place: EditPlace
    mask: NDArray[Any] | None

    @property
    def factors(self) -> dict[str, float]:
        """Factors by pigment."""
        return {"melanin": self.options.melanin, "hemoglobin": self.options.hemoglobin}

    def load(self) -> None:
        """Open the networks."""
        _open_networks(self.decomposer, self.options)

    def __call__(self, found: Found) -> int:
        """Edit a photograph, write it, and print what was written. Returns the number of faces."""
        source, picture, notes = _read(found)
        known, told_notes = self.told.tell(picture)
        edited = self.decomposer._edit(
            picture,
            self.factors,
            self.mask,
            source.name,
            faces=self.options.faces,
            region=self.options.region,
            capture=known,
            state=self.options.state,
        )
        if np.array_equal(edited.picture.pixels, picture.as_colour().pixels):
            raise InputError(self._describe_no_change(source.name))
        suffix, changes = self.place.choose_suffix(picture, source)
        try:
            target, told = self._write(edited, source, suffix)
        except InputError as error:
            raise NotWrittenError(str(error)) from error
        every = (*notes, *told_notes, *edited.picture.notes, *changes, *told)
        self._print(source, edited, target, suffix, tuple(dict.fromkeys(every)))
        return sum(each.face_id is not None for each in edited.faces)

    def _describe_no_change(self, name: str) -> str:
        masked = "" if self.mask is None else " where the mask is not black"
        return (
            f"No pixel of {name} changes, and nothing is written: no skin that can be edited was "
            f"found in it{masked}, or what is asked for is too little."
        )

    def _write(
        self, edited: Edited, source: Source, suffix: str
    ) -> tuple[Path | None, tuple[str, ...]]:
        """Write an edit. Returns its file, None for standard output, and notes."""
        mark, quality = Mark("edit", EDITED, source.digest), self.options.quality
        if self.place.kind is not Output.PIPE:
            place = self.place.make_folder(source)
            with _keep_names(place):
                target, numbered = self.place.choose_target(source, suffix, place)
                losses = write_picture(target, edited.picture, mark, quality)
            return target, (*numbered, *losses)
        with TemporaryDirectory() as folder:
            path = Path(folder) / f"{source.stem}_{EDITED}{suffix}"
            notes = write_picture(path, edited.picture, mark, quality, STANDARD_OUTPUT)
            _send(path.read_bytes())
        return None, notes

    def _print(
        self,
        source: Source,
        edited: Edited,
        target: Path | None,
        suffix: str,
        notes: tuple[str, ...],
    ) -> None:
        for sentence in notes:
            note(sentence)
        for face in edited.faces:
            explain(face.describe(source.name))
        if target is None:
            return
        if self.options.json:
            summary = self._summarise(source, edited, target, suffix, notes)
            print_line(json.dumps(summary, allow_nan=False))
        else:
            print_line(f"{source.name}: {target}")

    def _summarise(
        self, source: Source, edited: Edited, target: Path, suffix: str, notes: tuple[str, ...]
    ) -> dict[str, Any]:
        mask, wanted = self.options.mask, find_format(target)
        return {
            "file": source.name,
            "input": source.describe(target.parent),
            "output": str(target),
            "format": wanted.name,
            "quality": self.options.quality if wanted.is_lossy else None,
            "factors": self.factors,
            "states": {} if self.options.state is None else dict(self.options.state.amounts),
            "mask": None if mask is None else str(mask),
            "faces_found": edited.faces_found,
            "faces": [face.to_json() for face in edited.faces],
            "notes": list(notes),
            "version": __version__,
        }


def edit(options: argparse.Namespace) -> bool:
    """Edit every input; report bad inputs and continue. Returns whether none was bad."""
    _check(options)
    mask = None if options.mask is None else read_edit_mask(options.mask)
    found = walk(options.input, options.recursive)
    _pass_over_mask(found, options)
    place = EditPlace.from_options(options.output, options.format, found, options.input)
    workers, decomposer = _prepare(options, found)
    told = ToldCapture.from_options(options, decomposer, len(found.pictures))
    if mask is not None and len(found.pictures) > 1:
        note(f"{options.mask} is the mask of all {len(found.pictures)} photographs.")
    totals = run_over(
        found,
        _EditRun(decomposer, options, told, place, mask),
        lambda _, error: report(error),
        options.json,
        workers=workers,
        one_folder=place.path is not None,
    )
    for sentence in found.notes:
        note(sentence)
    if not is_one_file(found, options.input):
        note(describe_totals(totals, found, "edited", place.describe()))
    return not totals.failures


def _send(data: bytes) -> None:
    """Write to standard output.

    Raises:
        InputError: It cannot be written, for instance since a disk is full.
    """
    try:
        sys.stdout.buffer.write(data)
        sys.stdout.buffer.flush()
    except BrokenPipeError:
        raise
    except OSError as error:
        raise InputError(
            f"Standard output cannot be written ({error.strerror}); give a file with -o."
        ) from error


def _check(options: argparse.Namespace) -> None:
    """Refuse what can be refused before any photograph is read."""
    check_choice(options.faces)
    check_factors(melanin=options.melanin, hemoglobin=options.hemoglobin)
    check_state(options.state, options.region)
    if options.melanin == options.hemoglobin == 1 and options.state is None:
        # A mere copy would replace an earlier edit of the photograph.
        raise InputError(
            "Nothing is edited with factors of 1; give --melanin X, --hemoglobin X or --state NAME "
            "AMOUNT, such as --melanin 1.5."
        )
    if options.quality is not None:
        check_quality(options.quality)
    if options.json and options.output == "-":
        raise InputError(
            "-o - writes the picture to standard output, and --json a line; leave out one of them."
        )


def _pass_over_mask(found: Walk, options: argparse.Namespace) -> None:
    """Leave the mask out of the photographs of a folder or a pattern."""
    if options.mask is None:
        return
    for picture in list(found.pictures):
        if picture.path not in options.input and _is_same_file(picture.path, options.mask):
            found.pictures.remove(picture)
            found.passed_over.append(PassedOver(picture.path, _MASK))


def _is_same_file(one: str, other: Path) -> bool:
    try:
        return os.path.samefile(one, other)
    except (OSError, ValueError):
        return False
