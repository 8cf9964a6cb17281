"""The parts of faces, tinted: regions that are read, the sclera in green and the teeth in blue.

    python -m examples.face_parts [PHOTO ...] [-o runs/face_parts.png]

Each photograph shows its largest face twice, without and with the tint; a region that is hidden has
none. Without photographs it is demo/face_parts.png, from NASA's portrait of Eileen Collins, public
domain, which comes with scikit-image. Pictures of other people stay out of the project.
"""

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont
from skimage.data import astronaut

from examples._command import check_picture, run, write_picture
from skinnet import Decomposer, Decomposition
from skinnet.images import read_photo

TARGET, DEMO = Path("runs/face_parts.png"), Path("demo/face_parts.png")
SIDE = 420
"""Pixels of a face on the sheet."""

TINTS = {
    "forehead": (230, 60, 60),
    "left_cheek": (60, 190, 60),
    "right_cheek": (80, 80, 240),
    "nose": (240, 210, 40),
    "lips": (230, 60, 230),
    "chin": (40, 200, 200),
    "neck": (250, 150, 40),
    "eyelids": (150, 80, 250),
}
SCLERA, TEETH = (0, 255, 0), (0, 90, 255)
TINT_SHARE = 0.4

Picture = NDArray[np.uint8]


def draw_face(photo: Picture, face: Decomposition) -> Picture:
    """Draw a face without and with tints, [SIDE, 2 * SIDE, 3]."""
    tinted = photo.astype(np.float32)
    seen = [name for name, region in face.regions.items() if region.melanin.mean is not None]
    for name in seen:
        mask = face.region_mask(name)
        tinted[mask] += TINT_SHARE * (np.array(TINTS[name]) - tinted[mask])
    tinted[face.sclera], tinted[face.teeth] = SCLERA, TEETH
    plain, image = (_cut(each, face) for each in (photo, tinted.astype(np.uint8)))
    draw = ImageDraw.Draw(image)
    for name in seen:
        _write_name(draw, name, face)
    return np.hstack([np.array(plain), np.array(image)])


def _cut(photo: Picture, face: Decomposition) -> Image.Image:
    """The part of a photograph that was read, in the upper left corner of a square."""
    width, height = (round(_scale(face) * side) for side in (face.box.width, face.box.height))
    part = Image.fromarray(photo[face.box.slices]).resize((width, height), Image.Resampling.BICUBIC)
    square = Image.new("RGB", (SIDE, SIDE), (255, 255, 255))
    square.paste(part)
    return square


def _scale(face: Decomposition) -> float:
    return SIDE / max(face.box.width, face.box.height)


def _write_name(draw: ImageDraw.ImageDraw, name: str, face: Decomposition) -> None:
    """Write the name of a region onto its middle; of two eyelids onto the first."""
    rows, columns = np.nonzero(face.region_mask(name))
    column = columns.min() if name == "eyelids" else np.median(columns)
    place = np.array([column - face.box.left, np.median(rows) - face.box.top]) * _scale(face)
    x, y = place.tolist()
    draw.text((x, y), name.replace("_", " "), (0, 0, 0), ImageFont.load_default(12), "mm")


def draw(paths: Sequence[Path], output: Path | None) -> None:
    """Draw the faces of some photographs below each other."""
    target = output or (TARGET if paths else DEMO)
    check_picture(target, TARGET if paths else DEMO, "face_parts")
    decomposer = Decomposer()
    photos = [read_photo(path) for path in paths] or [astronaut()]
    faces = [draw_face(photo, decomposer(photo)) for photo in photos]
    write_picture(target, np.vstack(faces), "face_parts")


def main(arguments: list[str] | None = None) -> int:
    """Draw and write the sheet; return 2 for arguments that cannot be used."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("photos", nargs="*", type=Path, metavar="PHOTO")
    parser.add_argument("-o", "--output", type=Path)
    options = parser.parse_args(arguments)
    return run(lambda: draw(options.photos, options.output))


if __name__ == "__main__":
    sys.exit(main())
