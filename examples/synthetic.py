"""A contact sheet of 64 pictures of the synthetic renderer, with the heads of the validation set.

    python -m examples.synthetic [--ict ict_facekit.npz] [--beside PHOTOS] [-o runs/synthetic.png]

With a folder of photographs, a column of their faces stands beside the pictures, cropped as
training crops them. Visible differences between the two show what the renderer lacks.
"""

import argparse
import sys
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from examples._command import check_picture, run, write_picture
from skinnet.images import to_uint8
from train.portraits import find_crops
from train.synthetic.faces import SyntheticFaces

TARGET = Path("runs/synthetic.png")
SIDE, ACROSS, DOWN = 128, 8, 8
GAP = 12
"""White pixels between the pictures and the photographs."""

Picture = NDArray[np.uint8]


def render_pictures(ict: str | None, geometry: str) -> list[Picture]:
    """Render the first 64 pictures of the validation set."""
    count = ACROSS * DOWN
    data = SyntheticFaces(
        SIDE, ACROSS, val_heads=count, val_samples=count, ict=ict, geometry=geometry
    )
    data.setup("validate")
    rows = [data.render(scenes, "val").photograph for scenes in data.val_dataloader()]
    return [to_uint8(one.movedim(0, -1).numpy()) for row in rows for one in row]


def tile(pictures: list[Picture], across: int) -> Picture:
    """Put pictures of one size together row by row; what is missing at the end is white."""
    missing = -len(pictures) % across
    tiles = [*pictures, *[np.full_like(pictures[0], 255)] * missing]
    return np.concatenate(
        [np.concatenate(tiles[start : start + across], 1) for start in range(0, len(tiles), across)]
    )


def find_faces(folder: Path) -> Picture:
    """Find the first faces of a folder, as many as the sheet has rows, in one column."""
    return tile([crop.photograph for crop in find_crops(folder, SIDE)[0][:DOWN]], 1)


def add_column(sheet: Picture, column: Picture) -> Picture:
    """Add a column of photographs to a sheet."""
    pad = [(0, len(sheet) - len(column)), (GAP, 0), (0, 0)]
    return np.concatenate([sheet, np.pad(column, pad, constant_values=255)], 1)


def main(arguments: list[str] | None = None) -> int:
    """Render the sheet and write it; return 2 for arguments that cannot be used."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--ict", help="ICT-FaceKit's model as an .npz")
    parser.add_argument("--beside", type=Path, help="folder of photographs of faces")
    parser.add_argument("--geometry", default="runs/geometry", help="where heads are kept")
    parser.add_argument("-o", "--output", type=Path, default=TARGET)
    options = parser.parse_args(arguments)

    def draw() -> None:
        check_picture(options.output, TARGET, "synthetic")
        if options.beside is not None:
            column = find_faces(options.beside)
        picture = tile(render_pictures(options.ict, options.geometry), ACROSS)
        if options.beside is not None:
            picture = add_column(picture, column)
        write_picture(options.output, picture, "synthetic")

    return run(draw)


if __name__ == "__main__":
    sys.exit(main())
