"""What the examples share: refusals in a sentence, and pictures that replace no other file."""

import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from skinnet.errors import InputError
from skinnet.files import make_folder, write_atomically
from skinnet.images._mark import Mark, read_mark

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


def write_picture(
    path: Path, picture: NDArray[np.uint8], example: str, palette: bool = False
) -> None:
    """Write a picture, as small as PNG can, that says which example made it.

    With `palette` it has 256 colours, which is enough for a chart, and too few for skin.
    """
    make_folder(path.parent, "choose another file with -o")
    image = Image.fromarray(picture)
    text = Mark(_VERB, example).to_png_info()
    with write_atomically(path) as part:
        kept = image.quantize(256) if palette else image
        kept.save(part, format="PNG", optimize=True, pnginfo=text)
    print(f"written: {path}")
