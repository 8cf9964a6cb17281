"""The one walk through folders of pictures; what it leaves out is counted by reason."""

import glob
import os
import re
import stat
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import NamedTuple

from skinnet.errors import InputError
from skinnet.images import _found_files as files
from skinnet.images._kind import HEIF, Kind, is_readable, promises_picture
from skinnet.images._mark import EDITED, Mark, read_mark

STDIN = "-"
RESULT = Kind("a result of skinnet", "results of skinnet", "give the photograph itself")
SECOND_NAME = Kind("a second name of a file", "second names of files", "it is read once")
_FOLDER_AGAIN = Kind("a second way to a folder", "second ways to folders", "it is read once")
_ADDRESS = re.compile(r"\w+://")
_FORMATS = "JPEG, PNG, TIFF, WebP, AVIF, JPEG 2000, BMP, GIF or PPM files, whatever their ending"
_MOST_NAMES = 3


class Found(NamedTuple):
    """A picture to read with notes on it, or an error about what was asked for."""

    path: str
    error: InputError | None = None
    notes: tuple[str, ...] = ()


class PassedOver(NamedTuple):
    """A file that is not read, and what it is."""

    path: str
    kind: Kind


@dataclass
class Walk:
    """What a walk has found.

    Attributes:
        pictures: What to read, in order; the path of standard input is `-`.
        passed_over: Files that were found and are not read.
        notes: Sentences that the user should read.
    """

    pictures: list[Found] = field(default_factory=list)
    passed_over: list[PassedOver] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)

    def describe_passed_over(self) -> str:
        """Return the number of files by reason, with the first names; "" if there are none."""
        names: dict[Kind, list[str]] = {}
        for path, kind in self.passed_over:
            names.setdefault(kind, []).append(os.path.basename(path) or path)
        return "; ".join(_count(kind, each) for kind, each in names.items())


def walk(inputs: Sequence[str], recursive: bool = False) -> Walk:
    """Find the pictures that are named, in folders, and by patterns that no shell has expanded.

    What is a picture is decided by the content of a file. Hidden files and what file managers leave
    behind are skipped. A file is read once, however often it is named.

    Args:
        inputs: Files, folders, patterns, or `-` for standard input.
        recursive: Whether to search the subfolders too; else their pictures are counted.
    """
    walker = _Walker(recursive, len(inputs) == 1)
    for source in inputs:
        walker.add(source)
    return walker.found


def find_one(source: str) -> Found:
    """Find the one picture that is named, or by a pattern; a folder is left to the reader.

    Raises:
        InputError: None is there, or several match a pattern, or it is a result.
    """
    if source and os.path.isdir(source):
        return Found(source)
    pictures = walk([source]).pictures
    for picture in pictures:
        if picture.error is not None:
            raise picture.error
    if len(pictures) > 1:
        raise InputError(
            f"The pattern {source} matches {len(pictures)} photographs; give one of them."
        )
    return pictures[0]


def check_mark(mark: Mark | None, name: str) -> tuple[str, ...]:
    """Refuse a result that is given as a photograph.

    Returns:
        A note if it is a photograph that skinnet has edited.

    Raises:
        InputError: It is a map, a panel or another result.
    """
    if mark is None:
        return ()
    if mark.part == EDITED:
        return (f"{name} was edited by skinnet; its skin is read as it is after the edit.",)
    raise InputError(
        f"{name} is a result of skinnet ({mark.part}), not a photograph; give the photograph that "
        "it was made from."
    )


def describe_formats() -> str:
    """Say what photographs are, for messages that none was found."""
    return f"they are {_FORMATS}"


class _Walker:
    def __init__(self, recursive: bool, alone: bool) -> None:
        self.recursive = recursive
        self.alone = alone
        self.found = Walk()
        self.known: set[object] = set()

    def add(self, source: str) -> None:
        """Add an input that the user has named."""
        if not source:
            self._fail(source, "An empty name was given; name a photograph, a folder, or - .")
        elif source == STDIN:
            self._add_once(source, source)
        else:
            try:
                mode = os.stat(source).st_mode
            except (OSError, ValueError):
                self._add_absent(source)
            else:
                self._add_named(source, mode)

    def _add_named(self, source: str, mode: int) -> None:
        if stat.S_ISDIR(mode):
            self._add_folder(source)
        elif stat.S_ISREG(mode):
            self._add_file(source)
        else:
            sentence = "not a file; send its content to standard input and give - ."
            self._fail(source, f"{source} is {files.SPECIAL.one}, {sentence}")

    def _add_file(self, source: str) -> None:
        mark = read_mark(source)
        if mark is not None and mark.part == EDITED and not self.alone:
            self._pass_over(source, RESULT)
            return
        try:
            notes = check_mark(mark, source)
        except InputError as error:
            self.found.pictures.append(Found(source, error))
        else:
            self._add_once(source, files.get_identity(source), notes)

    def _add_absent(self, source: str) -> None:
        if os.path.islink(source):
            self._fail(source, files.describe_link(source))
        elif glob.has_magic(source):
            self._add_pattern(source)
        elif _ADDRESS.match(source):
            sentence = (
                "is an address; skinnet opens no connections. Load the file, and give its path."
            )
            self._fail(source, f"{source} {sentence}")
        else:
            self.found.pictures.append(Found(source))  # reading it says what is wrong

    def _add_pattern(self, pattern: str) -> None:
        before = self._count()
        matches = sorted(glob.glob(files.escape_existing(pattern), recursive=True))
        for path in matches:
            if not os.path.isdir(path):
                self._add_found(path)
            elif "**" not in pattern:
                self._add_folder(path, asked=False)
        if not matches:
            sentence = f"No file matches the pattern {pattern}; check the folder and the ending."
            self._fail(pattern, sentence)
        elif self._count() == before:
            sentence = f"No photograph matches the pattern {pattern}; {describe_formats()}."
            self._fail(pattern, sentence)

    def _add_folder(self, source: str, asked: bool = True) -> None:
        before, passed_over = self._count(), len(self.found.passed_over)
        below: list[Path] = []
        self._search(Path(source), below)
        pictures, folders, complete = files.count_below(below)
        number = f"{'' if complete else 'at least '}{pictures}"
        where = f"{number} in {folders} subfolder{'s' * (folders > 1)}"
        if self._count() > before:
            if pictures:
                note = f"{source} has further pictures, {where}; --recursive reads them too."
                self.found.notes.append(note)
        elif not asked or (not self.alone and self._has_results(passed_over)):
            pass  # a pattern of the shell, *, has named skinmaps too
        elif pictures:
            sentence = f"holds no photographs itself, but {where}; --recursive reads them."
            self._fail(source, f"The folder {source} {sentence}")
        elif self._has_results(passed_over):
            sentence = f"The folder {source} holds no photographs, only results of skinnet"
            self._fail(source, f"{sentence}; give the photographs that they were made from.")
        else:
            sentence = f"The folder {source} holds no photographs; {describe_formats()}."
            self._fail(source, sentence)

    def _has_results(self, start: int) -> bool:
        return any(kind is RESULT for _, kind in self.found.passed_over[start:])

    def _search(self, folder: Path, below: list[Path]) -> None:
        """Search a folder; without `recursive` its subfolders are only listed in `below`."""
        if not self._is_new(files.get_identity(folder)):
            self._pass_over(str(folder), _FOLDER_AGAIN)
            return
        try:
            names = sorted(os.listdir(folder))
        except OSError as error:
            reason = f"cannot be read ({error.strerror}); check its permissions."
            self._fail(str(folder), f"The folder {folder} {reason}")
            return
        for path in (folder / name for name in names if not files.is_litter(name)):
            if not os.path.isdir(path):
                self._add_found(str(path))
            elif self.recursive:
                self._search(path, below)
            else:
                below.append(path)

    def _add_found(self, path: str) -> None:
        """Add a file of a folder or a pattern if it is a picture; else pass over it."""
        kind = files.look_at(path)
        if kind is None or kind is files.BROKEN_LINK:
            self._add_unreachable(path, kind)
        elif is_readable(kind) and read_mark(path) is not None:
            self._pass_over(path, RESULT)
        elif is_readable(kind) or (kind is not files.SPECIAL and promises_picture(path, kind)):
            self._add_once(path, files.get_identity(path))  # reading it says what is wrong
        else:
            self._pass_over(path, RESULT if files.is_summary(path) else kind)

    def _add_unreachable(self, path: str, kind: Kind | None) -> None:
        if kind is None:
            self.found.pictures.append(Found(path))  # reading it says what is wrong
        elif promises_picture(path, kind):
            self._fail(path, files.describe_link(path))
        else:
            self._pass_over(path, kind)

    def _count(self) -> int:
        """The number of pictures found, also by a second name."""
        again = sum(kind in (SECOND_NAME, _FOLDER_AGAIN) for _, kind in self.found.passed_over)
        return len(self.found.pictures) + again

    def _add_once(self, source: str, identity: object, notes: tuple[str, ...] = ()) -> None:
        if self._is_new(identity):
            self.found.pictures.append(Found(source, None, notes))
        else:
            self._pass_over(source, SECOND_NAME)

    def _is_new(self, identity: object) -> bool:
        new = identity not in self.known
        self.known.add(identity)
        return new

    def _pass_over(self, path: str, kind: Kind) -> None:
        self.found.passed_over.append(PassedOver(path, kind))

    def _fail(self, path: str, sentence: str) -> None:
        self.found.pictures.append(Found(path, InputError(sentence)))


def _count(kind: Kind, names: list[str]) -> str:
    """Such as: 3 videos (a.mp4, b.mp4, c.mp4)."""
    listed = ", ".join(names[:_MOST_NAMES])
    more = f" and {len(names) - _MOST_NAMES} more" if len(names) > _MOST_NAMES else ""
    remedy = f"; {kind.remedy}" if kind is HEIF else ""
    name = re.sub("^an? ?", "", kind.one) if len(names) == 1 else kind.many  # another: other
    return f"{len(names)} {name} ({listed}{more}{remedy})"
