"""What the examples share: refusals in a sentence, and pictures that replace no other file."""

import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from skinnet.errors import InputError
from skinnet.files import make_folder
from skinnet.images._mark import Mark, read_mark
from skinnet.images._png_file import write_png

_VERB = "example"


def run(command: Callable[[], None]) -> int:
    """Run a command; return 0, or 2 with a sentence on standard error for bad input."""
    try:
        command()
    except (InputError, OSError) as error:
        print(error, file=sys.stderr)
        return 2
    return 0


def check_number(name: str, value: int, low: int, high: int) -> None:
    """Refuse a number outside a range."""
    if not low <= value <= high:
        raise InputError(f"{name} is a number from {low} to {high}; got {value}.")


def check_picture(path: Path, default: Path, example: str) -> None:
    """Refuse a picture's path without .png, and a file that this example did not write."""
    if path.suffix.lower() != ".png":
        raise InputError(f"{path} does not end in .png; the picture is written as PNG.")
    if path.is_dir():
        raise InputError(f"{path} is a folder; name the picture that is to be written.")
    mark = read_mark(path) if path.exists() else Mark(_VERB, example)
    if path != default and (mark is None or (mark.verb, mark.part) != (_VERB, example)):
        raise InputError(
            f"{path} is there already and was not written by this example; give another name with "
            "-o, or move it away."
        )


def write_picture(path: Path, picture: NDArray[np.uint8], example: str) -> None:
    """Write a picture that says which example made it."""
    make_folder(path.parent, "choose another file with -o")
    write_png(path, picture, Mark(_VERB, example).to_text())
    print(f"written: {path}")
