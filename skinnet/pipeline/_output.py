"""The folder that a verb writes into, and the names of its files."""

import json
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from jsonargparse import ArgumentParser

from skinnet.files import make_folder
from skinnet.inference._messages import print_line

MAPS_END = "_maps.npz"
"""End of the name of a file of maps."""

_FACE_ENDS = ("_face.obj", "_face.mtl", "_face.png")
_SHAPE_ENDS = ("_shape.npz", "_shape.obj", "_shape.png", "_shape.json")
_PIGMENT_ENDS = (MAPS_END, "_maps.json", "_melanin.png", "_hemoglobin.png", "_panel.png")

SCAN_ENDS = (*_SHAPE_ENDS, "_warp.npz", "_warp.json", *_PIGMENT_ENDS, *_FACE_ENDS)
"""Ends of the names of all files that the commands write for one scan."""

EDIT_ENDS = (MAPS_END, "_albedo.png", "_panel.png", "_render.png", *_FACE_ENDS)
"""Ends of the names of all files that edit-maps writes."""


def make_output_folder(folder: Path) -> Path:
    """Make the folder that a verb writes into, if needed."""
    return make_folder(folder, "choose another folder with -o")


def add_output(parser: ArgumentParser, default: str) -> None:
    """Add the option for the folder that a verb writes into."""
    parser.add_argument(
        "-o", "--output", type=Path | None, default=None, help=f"Folder; by default {default}."
    )


def add_json(parser: ArgumentParser, what: str) -> None:
    """Add the flag for results in JSON."""
    parser.add_argument(
        "--json", action="store_true", help=f"Print {what.lower()} as one line of JSON, no text."
    )


def print_result(
    line: str, record: Mapping[str, Any], files: Iterable[Path], as_json: bool
) -> None:
    """Print what a verb has made, as a line for people or as one line of JSON.

    Args:
        line: The line for people.
        record: The numbers.
        files: The files that were written, which JSON lists after the numbers.
        as_json: Whether JSON is asked for.
    """
    if as_json:
        line = json.dumps({**record, "files": [str(file) for file in files]}, allow_nan=False)
    print_line(line)


def add_end(stem: Path, end: str) -> Path:
    """Append an end such as _maps.npz to FOLDER/NAME."""
    return stem.with_name(stem.name + end)
