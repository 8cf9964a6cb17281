"""Flags of `skinnet shader`."""

import argparse
import re
from pathlib import Path

from skinnet.inference._command.shared_arguments import add_json

TARGETS = ("blender", "materialx", "glsl", "osl")

FOLDER = "skinshader"
"""Folder to write to, where none is given."""


def add_shader(verb: argparse.ArgumentParser) -> None:
    """Add the flags of `skinnet shader`."""
    verb.add_argument(
        "maps",
        nargs="*",
        type=Path,
        help="maps of melanin, hemoglobin and the offset that the material reads, as skinnet "
        "invert and skinnet maps write them; without maps it has sliders alone",
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
        type=Path,
        default=Path(FOLDER),
        metavar="DIR",
        help=f"folder to write to; {FOLDER} by default",
    )
    verb.add_argument("--overwrite", action="store_true", help="replace files that are there")
    verb.add_argument(
        "--light",
        default="D65",
        metavar="NAME",
        help="light of the colours: D65 (the default), another daylight, A, FL11, LED-B3 and "
        "others, or a .csv file of wavelength and power",
    )
    verb.add_argument(
        "--camera",
        default="observer",
        metavar="NAME",
        help="what sees the colours: observer (CIE 1931, the default, as of skinnet invert), a "
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
