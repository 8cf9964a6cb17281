"""Three people of light, medium and dark skin: photograph, melanin, hemoglobin and two edits.

    python -m examples.strip --ict ict_facekit.npz [-o demo/strip.png] [--size 480]

The photographs are renders of the project's own, so that the truth is known. Each map says what the
shipped model reads, as the range of nine in ten true means, and what is true. Without the file that
`python -m tools.ict_facekit` makes of a checkout of ICT-FaceKit, the heads are procedural.
"""

import argparse
import sys
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from examples._command import check_number, check_picture, run, write_picture
from examples._portraits import Portrait, Sitter, render_portrait
from skinnet import Decomposer, Decomposition
from skinnet.inference._tiles import TILE, draw_grid, draw_picture, draw_pigment_map

TARGET = Path("demo/strip.png")
SITTERS = (
    Sitter("light skin", 3, 262, 0.2),
    Sitter("medium skin", 13, 116, -0.2),
    Sitter("dark skin", 11, 170, 0.2),
)
EDITS = {"melanin": 1.5, "hemoglobin": 2.0}


def draw_person(sitter: Sitter, portrait: Portrait, decomposer: Decomposer) -> list[Image.Image]:
    """Draw a row of tiles."""
    face = decomposer(portrait.photo)
    tiles = [draw_picture(f"{sitter.name}, rendered", portrait.photo)]
    for pigment in EDITS:
        note = _compare(face, portrait, pigment)
        print(f"{sitter.name:12} {pigment:10} {note}")
        values = face.maps()[pigment]
        tiles.append(draw_pigment_map(pigment, values, face.mask, note=note))
    for pigment, factor in EDITS.items():
        edited = decomposer.edit(portrait.photo, **{pigment: factor})
        tiles.append(draw_picture(f"{pigment} x {factor:g}", edited))
    return tiles


def _compare(face: Decomposition, portrait: Portrait, pigment: str) -> str:
    """The range that holds nine of ten true means, beside the true mean."""
    low, high = face.interval()[pigment]
    true = getattr(portrait, pigment)
    return f"{100 * low:.1f} to {100 * high:.1f} %, true {100 * true:.1f} %"


def draw_strip(size: int, ict: Path | None) -> NDArray[np.uint8]:
    """Draw the strip; the scale of a map stands below its column."""
    decomposer = Decomposer()
    rows = [draw_person(one, render_portrait(one, size, ict), decomposer) for one in SITTERS]
    height = rows[0][0].height
    for row in rows[:-1]:
        row[:] = [tile.crop((0, 0, TILE, height)) for tile in row]
    return draw_grid([tile for row in rows for tile in row], len(rows[0]))


def main(arguments: list[str] | None = None) -> int:
    """Draw the strip and write it; return 2 for arguments that cannot be used."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--ict", type=Path, help="ICT-FaceKit's model as an .npz")
    parser.add_argument("-o", "--output", type=Path, default=TARGET)
    parser.add_argument("--size", type=int, default=480, help="pixels along a side of a portrait")
    options = parser.parse_args(arguments)

    def draw() -> None:
        check_number("size", options.size, 96, 2048)
        check_picture(options.output, TARGET, "strip")
        write_picture(options.output, draw_strip(options.size, options.ict), "strip")

    return run(draw)


if __name__ == "__main__":
    sys.exit(main())
