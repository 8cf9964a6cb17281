"""People of all tones with their mask, their maps and edits, to judge masks and edits by eye.

    python -m examples.contact_sheet PORTRAITS [-o runs/contact_sheet.png] [--people 24]

The portraits of a folder are ordered by the tone of their cheeks, and people are taken at even
distances from the palest to the darkest. A row shows the head, the edge of the mask on it, what the
mask cuts out before a colour that no skin has, both pigments, and edits. Six rows are a page:
contact_sheet_1.png and so on. The pictures show real people and stay out of the project.
"""

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from PIL import Image
from scipy import ndimage
from skimage.color import rgb2lab

from examples._command import check_number, check_picture, run, write_picture
from skinnet import Decomposer
from skinnet.errors import InputError
from skinnet.images import find_faces, frame_head, read_photo, resize
from skinnet.images._walk import walk
from skinnet.inference._tiles import draw_grid, draw_picture, draw_pigment_map
from skinnet.inference.decomposition import SKIN_THRESHOLD

TARGET = Path("runs/contact_sheet.png")
ROWS = 6
EDITS = (
    ("melanin", 0.4),
    ("melanin", 2.0),
    ("melanin", 3.0),
    ("hemoglobin", 0.4),
    ("hemoglobin", 3.0),
)
MARGIN = 1.7
"""Side of the head's square in sides of the face's box."""

LARGEST = 2400
"""Longer side in pixels to which photographs are reduced first."""

BEHIND = (0, 190, 90)
"""A green that is far from every skin."""

CHEEKS = [50, 101, 205, 280, 330, 425]
"""Landmarks of MediaPipe's mesh on both cheeks."""


class Person(NamedTuple):
    """A portrait with one face or more.

    Attributes:
        name: The file's name without its ending.
        photo: uint8 sRGB [H, W, 3].
        tone: Typology angle of the cheeks in degrees; the palest have the largest.
    """

    name: str
    photo: NDArray[np.uint8]
    tone: float


def find_people(folder: Path) -> list[Person]:
    """Read the portraits of a folder, the palest first; those without a face are left out."""
    people = []
    for found in walk([str(folder)]).pictures:
        photo = _reduce(read_photo(found.path))
        if faces := find_faces(photo):
            face = max(faces, key=lambda face: face.box.width)
            tone = measure_tone(photo, face.landmarks[CHEEKS], face.box.width / 20)
            people.append(Person(Path(found.path).stem, photo, tone))
    if not people:
        raise InputError(f"{folder} has no picture with a face; name a folder of portraits.")
    return sorted(people, key=lambda person: -person.tone)


def measure_tone(photo: NDArray[np.uint8], places: NDArray[np.float32], radius: float) -> float:
    """Typology angle in degrees of the median colour around some places (column, row)."""
    half = max(1, round(radius))
    patches = []
    for x, y in places.round().astype(int):
        patch = photo[max(0, y - half) : y + half, max(0, x - half) : x + half]
        patches.append(patch.reshape(-1, 3))
    lightness, _, b = rgb2lab(np.median(np.concatenate(patches), 0) / 255)
    return float(np.degrees(np.arctan2(lightness - 50, b)))


def choose_people(people: Sequence[Person], count: int) -> list[Person]:
    """Choose people at even distances of tone, each one once."""
    chosen: list[Person] = []
    left = list(people)
    for tone in np.linspace(people[0].tone, people[-1].tone, min(count, len(people))):
        nearest = min(left, key=lambda person: abs(person.tone - tone))
        left = [person for person in left if person is not nearest]
        chosen.append(nearest)
    return sorted(chosen, key=lambda person: -person.tone)


def draw_person(person: Person, decomposer: Decomposer) -> list[Image.Image]:
    """Draw a row of tiles."""
    photo = person.photo
    decomposition = decomposer(photo)
    face = max(find_faces(photo), key=lambda face: face.box.width)
    head = frame_head(face.box, photo.shape[1], photo.shape[0], MARGIN).slices
    mask = decomposition.mask[head]
    tiles = [
        draw_picture(f"{person.name}, {person.tone:.0f}", photo[head]),
        draw_picture("edge of the mask", draw_edge(photo[head], mask)),
        draw_picture("mask", cut_out(photo[head], mask)),
    ]
    for pigment in ("melanin", "hemoglobin"):
        tiles.append(draw_pigment_map(pigment, decomposition.maps()[pigment][head], mask))
    for pigment, factor in EDITS:
        edited = decomposer.edit(photo, **{pigment: factor})
        tiles.append(draw_picture(f"{pigment} x {factor:g}", edited[head]))
    return tiles


def draw_edge(photo: NDArray[np.uint8], mask: NDArray[np.float32]) -> NDArray[np.uint8]:
    """Draw a line where the mask passes the least value that counts as skin."""
    inside = mask > SKIN_THRESHOLD
    width = max(1, round(max(mask.shape) / 250))
    edge = inside & ~ndimage.binary_erosion(inside, iterations=width)
    drawn = photo.copy()
    drawn[edge] = BEHIND
    return drawn


def cut_out(photo: NDArray[np.uint8], mask: NDArray[np.float32]) -> NDArray[np.uint8]:
    """Show what the mask keeps before a green that is far from every skin."""
    weight = mask.clip(0, 1)[..., None]
    return (weight * photo + (1 - weight) * np.array(BEHIND)).round().astype(np.uint8)


def draw_sheets(folder: Path, count: int) -> list[NDArray[np.uint8]]:
    """Draw the pages of a folder's portraits."""
    decomposer = Decomposer()
    people = choose_people(find_people(folder), count)
    sheets = []
    for start in range(0, len(people), ROWS):
        rows = [draw_person(person, decomposer) for person in people[start : start + ROWS]]
        sheets.append(draw_grid([tile for row in rows for tile in row], len(rows[0])))
    return sheets


def main(arguments: list[str] | None = None) -> int:
    """Draw the pages and write them; return 2 for arguments that cannot be used."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("portraits", type=Path, help="a folder of portraits")
    parser.add_argument("-o", "--output", type=Path, default=TARGET)
    parser.add_argument("--people", type=int, default=24, help="number of people")
    options = parser.parse_args(arguments)

    def draw() -> None:
        check_number("people", options.people, 1, 1000)
        output: Path = options.output
        sheets = draw_sheets(options.portraits, options.people)
        for number, sheet in enumerate(sheets, 1):
            path = output.with_name(f"{output.stem}_{number}{output.suffix}")
            check_picture(path, path if output == TARGET else output, "contact_sheet")
            write_picture(path, sheet, "contact_sheet")

    return run(draw)


def _reduce(photo: NDArray[np.uint8]) -> NDArray[np.uint8]:
    scale = min(1, LARGEST / max(photo.shape[:2]))
    size = round(photo.shape[1] * scale), round(photo.shape[0] * scale)
    return photo if scale == 1 else resize(photo, *size)


if __name__ == "__main__":
    sys.exit(main())
