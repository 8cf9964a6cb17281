"""Flags of `skinnet shader`."""

import argparse
import re
from pathlib import Path

from skinnet.inference._command.shared_arguments import add_json, read_texture_folder

TARGETS = ("blender", "materialx", "glsl", "osl")

FOLDER = "skinshader"
"""Folder to write to, where none is given."""


def add_shader(verb: argparse.ArgumentParser) -> None:
    """Add the flags of `skinnet shader`."""
    verb.add_argument(
        "maps",
        nargs="*",
        type=Path,
        help="NAME_maps.json of skinnet invert, or maps of melanin, hemoglobin and the offset, as "
        "skinnet invert and skinnet maps write them; without maps the material has sliders alone",
    )
    verb.add_argument(
        "--original",
        type=Path,
        metavar="FILE",
        help="texture that skinnet invert read, where it is no longer in its place",
    )
    verb.add_argument(
        "--target",
        action="append",
        choices=TARGETS,
        help="for what it is written: blender, materialx, glsl or osl; give the flag again for "
        "more; all by default",
    )
    verb.add_argument(
        "-o",
        "--output",
        type=read_texture_folder,
        default=Path(FOLDER),
        metavar="DIR",
        help=f"folder to write to; {FOLDER} by default",
    )
    verb.add_argument("--overwrite", action="store_true", help="replace files that are there")
    verb.add_argument(
        "--light",
        metavar="NAME",
        help="light of the colours: that of the maps (the default), else D65; another daylight, A, "
        "FL11, LED-B3 and others, or a .csv file of wavelength and power",
    )
    verb.add_argument(
        "--camera",
        metavar="NAME",
        help="what sees the colours: that of the maps (the default), else observer (CIE 1931); a "
        "camera, mean for the mean of 52 cameras, or a .csv file of sensitivities",
    )
    verb.add_argument(
        "--size",
        type=_read_size,
        default=(256, 128),
        metavar="MxH",
        help="nodes of the table in melanin and in hemoglobin, 16 to 2048; 256x128 by default",
    )
    verb.add_argument(
        "--blender",
        metavar="PROGRAM",
        help="Blender, or a Python that has bpy, which makes skin.blend; by default what is found",
    )
    add_json(verb, "what was written")


def _read_size(word: str) -> tuple[int, int]:
    found = re.fullmatch(r"(\d{1,9})[xX](\d{1,9})", word.strip())
    if found is None:
        raise argparse.ArgumentTypeError(f"--size is two whole numbers, as 256x128; got {word!r}.")
    return int(found[1]), int(found[2])
