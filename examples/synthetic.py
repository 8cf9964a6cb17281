"""A contact sheet of 48 pictures of the synthetic renderer, and one of their masks of skin.

    python -m examples.synthetic [--variety mild] [--captures wide] [--ict ict_facekit.npz]
        [--beside PHOTOS] [-o runs/synthetic.png]

The pictures are the first of the validation set. The second sheet, whose name ends in _mask,
tints the true skin green. With a folder of photographs, a column of their faces stands beside the
pictures, cropped as training crops them. Visible differences between the two show what the renderer
lacks.
"""

import argparse
import sys
from pathlib import Path
from typing import get_args

import numpy as np
from numpy.typing import NDArray

from examples._command import check_picture, run, write_picture
from skinnet.images import to_uint8
from train.batch import Batch
from train.portraits import find_crops
from train.synthetic.faces import SyntheticFaces
from train.synthetic.variety import Captures, Variety

TARGET = Path("runs/synthetic.png")
SIDE, ACROSS, DOWN = 160, 8, 6
GAP = 12
"""White pixels between the pictures and the photographs."""

TINT = (0.1, 1.0, 0.2)
TINT_SHARE = 0.5

Picture = NDArray[np.uint8]


def render_batches(
    variety: Variety, captures: Captures, ict: str | None, geometry: str
) -> list[Batch]:
    """Render the first 48 pictures of the validation set."""
    count = ACROSS * DOWN
    data = SyntheticFaces(
        SIDE,
        ACROSS,
        val_heads=count,
        val_samples=count,
        ict=ict,
        geometry=geometry,
        variety=variety,
        captures=captures,
    )
    data.setup("validate")
    return [data.render(scenes, "val") for scenes in data.val_dataloader()]


def list_pictures(batch: Batch, tinted: bool) -> list[Picture]:
    """List the photographs of a batch, with or without a tint over skin."""
    share = TINT_SHARE * tinted * batch.mask[:, None]
    tint = batch.photograph.new_tensor(TINT)[:, None, None]
    pictures = (batch.photograph * (1 - TINT_SHARE * tinted) + share * tint).clamp(0, 1)
    return [to_uint8(one.movedim(0, -1).numpy()) for one in pictures]


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


def draw(options: argparse.Namespace) -> None:
    """Render both sheets and write them."""
    mask = options.output.with_stem(f"{options.output.stem}_mask")
    check_picture(options.output, TARGET, "synthetic")
    check_picture(mask, TARGET.with_stem(f"{TARGET.stem}_mask"), "synthetic")
    column = None if options.beside is None else find_faces(options.beside)
    batches = render_batches(options.variety, options.captures, options.ict, options.geometry)
    for path, tinted in ((options.output, False), (mask, True)):
        pictures = [one for batch in batches for one in list_pictures(batch, tinted)]
        sheet = tile(pictures, ACROSS)
        if column is not None and not tinted:
            sheet = add_column(sheet, column)
        write_picture(path, sheet, "synthetic")


def main(arguments: list[str] | None = None) -> int:
    """Render the sheets and write them; return 2 for arguments that cannot be used."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--variety", choices=get_args(Variety), default="any")
    parser.add_argument("--captures", choices=get_args(Captures), default="mild")
    parser.add_argument("--ict", help="ICT-FaceKit's model as an .npz")
    parser.add_argument("--beside", type=Path, help="folder of photographs of faces")
    parser.add_argument("--geometry", default="runs/geometry", help="where heads are kept")
    parser.add_argument("-o", "--output", type=Path, default=TARGET)
    options = parser.parse_args(arguments)
    return run(lambda: draw(options))


if __name__ == "__main__":
    sys.exit(main())
