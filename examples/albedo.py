"""Edits of three synthetic albedos by `skinnet edit-albedo`, for docs/albedo.md.

    python -m examples.albedo [-o docs/figures] [--texels 1024]

The albedos are those of people whom `examples.lightstage` paints, of light, medium and dark skin.
Four pictures are written: albedo_presets.png, albedo_brushes.png, albedo_strong.png and, with a
cheek of 150 texels, albedo_closeup.png.
"""

import argparse
import sys
from contextlib import redirect_stdout
from io import StringIO
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import torch
from numpy.typing import NDArray
from PIL import Image

from examples._command import check_number, check_picture, run, write_picture
from examples.lightstage import paint_person
from skinnet.appearance.colour import SkinColour
from skinnet.cli import main as run_skinnet
from skinnet.errors import InputError
from skinnet.images import linear_to_srgb, resize, to_uint8
from skinnet.images._png_file import write_png
from skinnet.inference._tiles import draw_grid, draw_picture
from skinnet.physics import load_spectrum_to_srgb

TARGET = Path("docs/figures")
TONES = {"light": 19, "medium": 24, "dark": 7}
"""Numbers of the people, of 25."""

PICTURES: dict[str, dict[str, list[str]]] = {
    "presets": {
        "blush": ["--preset", "blush"],
        "tan": ["--preset", "tan"],
        "pallor": ["--preset", "pallor"],
        "vitiligo": ["--preset", "vitiligo"],
    },
    "brushes": {
        "freckles": ["--brush", "freckles:u=0.5,v=0.48,radius=0.3,count=700"],
        "moles": ["--brush", "moles:u=0.5,v=0.45,radius=0.3,count=8"],
        "flush": ["--brush", "flush:u=0.37,v=0.4", "--brush", "flush:u=0.63,v=0.4,seed=1"],
        "tan-line": ["--brush", "tan-line:v=0.52,width=0.1"],
        "patches": ["--brush", "patches:u=0.5,v=0.45,radius=0.4,size=0.1,seed=3"],
    },
    "strong": {
        "melanin x .3": ["--melanin", "0.3"],
        "melanin x 3": ["--melanin", "3"],
        "hemoglobin x .3": ["--hemoglobin", "0.3"],
        "hemoglobin x 3": ["--hemoglobin", "3"],
    },
}
CLOSE = {name: PICTURES["brushes"][name] for name in ("freckles", "moles", "flush", "patches")}

_FACE, _CHEEK = (0.2, 0.24, 0.6), (0.3, 0.5, 0.15)
"""Left, top and side of what is shown, in sides of the texture."""

Picture = NDArray[np.uint8]


def draw(options: argparse.Namespace) -> None:
    """Write the four pictures."""
    check_number("texels", options.texels, 64, 4096)
    names = [*PICTURES, "closeup"]
    files = {name: options.output / f"albedo_{name}.png" for name in names}
    for file in files.values():
        check_picture(file, TARGET / file.name, "albedo")
    albedos = {tone: paint_albedo(number, options.texels) for tone, number in TONES.items()}
    groups = [*((name, words, _FACE) for name, words in PICTURES.items())]
    for name, edits, place in (*groups, ("closeup", CLOSE, _CHEEK)):
        tiles = [tile for one in albedos.items() for tile in draw_row(*one, edits, place)]
        sheet = draw_grid(tiles, 1 + len(edits))
        half = resize(sheet, sheet.shape[1] // 2, sheet.shape[0] // 2)
        write_picture(files[name], half, "albedo")


def paint_albedo(number: int, texels: int) -> Picture:
    """Paint the albedo of a person: skin under D65 as people see it, with brows and lips."""
    person = paint_person(number, 25, texels)
    matrix = load_spectrum_to_srgb("D65", "observer").numpy()
    flat = (torch.from_numpy(person[name].ravel()) for name in ("f_mel", "f_blood"))
    skin = SkinColour(matrix).skin(*flat).numpy().reshape(3, texels, texels)
    linear = skin + person["cover"] * (person["paint"] - skin)
    return to_uint8(linear_to_srgb(np.moveaxis(linear, 0, -1)))


def draw_row(
    tone: str, albedo: Picture, edits: dict[str, list[str]], place: tuple[float, float, float]
) -> list[Image.Image]:
    """Draw tiles of one albedo and its edits."""
    pictures = {tone: albedo} | {name: edit(albedo, words) for name, words in edits.items()}
    left, top, side = (round(share * len(albedo)) for share in place)
    shown = slice(top, top + side), slice(left, left + side)
    return [draw_picture(name, picture[shown]) for name, picture in pictures.items()]


def edit(albedo: Picture, words: list[str]) -> Picture:
    """Edit an albedo by the command."""
    with TemporaryDirectory() as folder:
        path = Path(folder, "albedo.png")
        write_png(path, albedo, {})
        with redirect_stdout(StringIO()):
            if run_skinnet(["edit-albedo", "-q", str(path), *words]):
                raise InputError(f"skinnet edit-albedo {' '.join(words)} has failed.")
        with Image.open(path.with_name("albedo_edited.png")) as picture:
            return np.array(picture)


def main(arguments: list[str] | None = None) -> int:
    """Draw the pictures; return 2 for arguments that cannot be used."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("-o", "--output", type=Path, default=TARGET)
    parser.add_argument("--texels", type=int, default=1024)
    options = parser.parse_args(arguments)
    return run(lambda: draw(options))


if __name__ == "__main__":
    sys.exit(main())
