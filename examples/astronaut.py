"""Melanin and hemoglobin of a photograph, and two edits of them, with the shipped model.

    python -m examples.astronaut [-o demo/astronaut.png]

The photograph is NASA's portrait of Eileen Collins, public domain, which comes with scikit-image.
"""

import argparse
import sys
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from skimage.data import astronaut

from examples._command import check_picture, run, write_picture
from skinnet import Decomposer
from skinnet.inference._tiles import draw_grid, draw_picture, draw_pigment_map

TARGET = Path("demo/astronaut.png")


def draw_row() -> NDArray[np.uint8]:
    """Draw a row of tiles: photograph, two maps, reconstruction, two edits."""
    decomposer = Decomposer()
    photo = astronaut()
    face = decomposer(photo)
    head = face.box.slices
    mask = face.mask[head]

    # Half as much melanin again looks like a tan, twice the blood like a flush.
    tanned = decomposer.edit(photo, melanin=1.5)
    flushed = decomposer.edit(photo, hemoglobin=2.0)

    for name, numbers in face.summary()["maps"].items():
        print(f"{name:12} {numbers['mean']:8.4f} +- {numbers['std']:.4f} {numbers['unit']}")
    tiles = [
        draw_picture("photograph", photo[head]),
        draw_pigment_map("melanin", face.melanin[head], mask),
        draw_pigment_map("hemoglobin", face.hemoglobin[head], mask),
        draw_picture("reconstruction", face.reconstruction[head]),
        draw_picture("melanin x 1.5", tanned[head]),
        draw_picture("hemoglobin x 2", flushed[head]),
    ]
    return draw_grid(tiles, len(tiles))


def main(arguments: list[str] | None = None) -> int:
    """Draw the row and write it; return 2 for arguments that cannot be used."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("-o", "--output", type=Path, default=TARGET)
    options = parser.parse_args(arguments)

    def draw() -> None:
        check_picture(options.output, TARGET, "astronaut")
        write_picture(options.output, draw_row(), "astronaut")

    return run(draw)


if __name__ == "__main__":
    sys.exit(main())
