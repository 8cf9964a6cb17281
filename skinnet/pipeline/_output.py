"""The folder that a verb writes into, and the names of its files."""

from pathlib import Path

from jsonargparse import ArgumentParser

from skinnet.files import make_folder

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


def add_end(stem: Path, end: str) -> Path:
    """Append an end such as _maps.npz to FOLDER/NAME."""
    return stem.with_name(stem.name + end)
