"""Where edits are written: beside their photographs, to a file, to a folder, to standard output."""

import os
import sys
from enum import Enum
from pathlib import Path
from typing import NamedTuple

from skinnet.errors import InputError
from skinnet.images._mark import EDITED
from skinnet.images._walk import STDIN, Walk
from skinnet.images._write import choose_suffix, find_format, has_format
from skinnet.images.picture import Picture
from skinnet.inference._own_results import Source, choose_edit_target
from skinnet.inference.results import _make_folder

STANDARD_OUTPUT = "standard output"


class Output(Enum):
    """What an output is."""

    BESIDE = "the photograph's folder"
    FILE = "a file"
    FOLDER = "a folder"
    PIPE = STANDARD_OUTPUT


class EditPlace(NamedTuple):
    """Where the edits of a run are written.

    Attributes:
        kind: What the output is.
        path: The file or the folder; None of the others.
        suffix: Suffix of the format that is asked for; "" for that of each photograph.
    """

    kind: Output
    path: Path | None = None
    suffix: str = ""

    @classmethod
    def from_options(
        cls, output: str | None, format_: str | None, found: Walk, inputs: list[str]
    ) -> "EditPlace":
        """Check where the edits of some photographs are to be written.

        Args:
            output: A file, a folder, `-` for standard output, or None for beside the photographs.
            format_: A suffix without its dot, or None.
            found: The photographs.
            inputs: How the user has named them.

        Raises:
            InputError: The output does not fit the photographs or the format.
        """
        suffix = f".{format_}" if format_ else ""
        if suffix:
            find_format(Path(f"the edit{suffix}"))
        if output is None:
            return cls(Output.BESIDE, None, suffix)
        if output == STDIN:
            _check_pipe(len(found.pictures))
            return cls(Output.PIPE, None, suffix)
        path = Path(output)
        if path.is_dir() or output.endswith(("/", os.sep)):
            return cls(Output.FOLDER, path, suffix)
        if not _is_one(found, inputs, path):
            _refuse_file(path, len(found.pictures))
            return cls(Output.FOLDER, path, suffix)
        _check_format(path, suffix)
        return cls(Output.FILE, path)

    def describe(self) -> str:
        """Where the edits are, for the end of a run."""
        return f"edits in {self.path}" if self.kind is Output.FOLDER else ""

    def choose_suffix(self, picture: Picture, source: Source) -> tuple[str, tuple[str, ...]]:
        """Choose the suffix of an edit, with a note if its format is not the photograph's own."""
        own = "" if source.path is None else source.path.suffix
        if self.kind is Output.FILE and self.path is not None:
            return self.path.suffix, ()
        if not self.suffix:
            return choose_suffix(picture, own)
        same = has_format(own) and find_format(Path(f"a{own}")) is find_format(
            Path(f"a{self.suffix}")
        )
        return (own if same else self.suffix), ()

    def make_folder(self, source: Source) -> Path:
        """The folder of an edit, which is made if it is one that the user has named.

        Raises:
            InputError: It cannot be made.
        """
        if self.path is None:
            return source.folder
        return self.path.parent if self.kind is Output.FILE else _make_folder(self.path)

    def choose_target(
        self, source: Source, suffix: str, folder: Path
    ) -> tuple[Path, tuple[str, ...]]:
        """Choose the file of an edit in its folder, with a note if its name has a number.

        Raises:
            InputError: The file that is asked for is the photograph itself or another file.
        """
        output = self.path if self.kind is Output.FILE else None
        target = choose_edit_target(source, output, suffix, folder)
        usual = f"{source.stem}_{EDITED}{suffix}"
        if output is not None or target.name == usual:
            return target, ()
        return target, (
            f"{folder / usual} is another file; the edit of {source.name} is numbered: "
            f"{target.name}.",
        )


def _check_pipe(count: int) -> None:
    if count != 1:
        raise InputError(
            f"-o - writes one picture to standard output, and {count} photographs are given; give "
            "a folder with -o."
        )
    if sys.stdout is not None and sys.stdout.isatty():
        raise InputError(
            "Standard output is a terminal, which cannot show a picture; add > FILE, or give a "
            "file with -o."
        )


def _is_one(found: Walk, inputs: list[str], output: Path) -> bool:
    """Whether the output is a file: for one photograph that is named, or matches a pattern."""
    if len(inputs) != 1 or len(found.pictures) != 1 or os.path.isdir(inputs[0]):
        return False
    return found.pictures[0].path == inputs[0] or has_format(output.suffix)


def _refuse_file(path: Path, count: int) -> None:
    if has_format(path.suffix):
        photographs = f"{count} photograph{'s are' if count != 1 else ' of a folder is'} edited"
        raise InputError(
            f"{path} would be one picture, and {photographs}; give a folder with -o, such as "
            f"{path.with_suffix('')}/."
        )


def _check_format(path: Path, suffix: str) -> None:
    if not path.suffix:
        raise InputError(
            f"{path} has no ending that names a format, such as .jpg or .png; if it is to be a "
            f"folder, give {path}{os.sep} with -o."
        )
    wanted = find_format(path)
    if suffix and find_format(Path(f"a{suffix}")) is not wanted:
        raise InputError(
            f"{path} is {wanted.name} by its ending, and --format {suffix[1:]} is another; leave "
            "out one."
        )
    if not path.parent.exists():
        raise InputError(
            f"{path} cannot be written, since there is no folder {path.parent}; make it first."
        )
