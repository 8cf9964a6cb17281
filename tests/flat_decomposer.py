"""A decomposer without a network, whose melanin says which photograph was read; and its command."""

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

from skinnet.cli import main
from skinnet.errors import NoFaceError
from skinnet.images import Box
from skinnet.images._png_file import write_png
from skinnet.images.picture import Picture
from skinnet.inference._edited import Edited, EditedFace
from skinnet.inference._editing import ColourMeans
from skinnet.inference._uncertainty import Uncertainty
from skinnet.inference.decomposer import Decomposer
from skinnet.inference.decomposition import Decomposition
from skinnet.inference.onnx_model import OutputInfo

INFO = {
    name: OutputInfo("fraction", (0.0, 1.0), name)
    for name in ("melanin", "hemoglobin", "shading", "specular", "mask", "offset")
}
SKIN = (200, 140, 120)
"""A colour that is read as melanin 0.200."""

WALL = (255, 255, 255)
"""A colour in which no face is found."""


PEOPLE = 3
"""Faces that are found if all are asked for."""


class FlatDecomposer(Decomposer):
    """Reads a thousandth of the red of the first pixel as melanin; white has no face."""

    def __init__(self, model: object = None, **_: object) -> None:
        pass

    def load(self) -> None:
        """Nothing is to be opened."""

    def __call__(
        self, picture: Picture, *, name: str, faces: str | int, **_: object
    ) -> list[Decomposition]:
        photo = picture.srgb
        count = faces if isinstance(faces, int) else {"largest": 1, "all": PEOPLE}[faces]
        height, width = photo.shape[:2]
        _find_face(replace(picture, name=name))
        flat = np.full((height, width), photo[0, 0, 0] / 1000, np.float32)
        one = Decomposition(
            *(flat, flat / 2, flat, flat, np.ones_like(flat), np.zeros((*flat.shape, 3), "f4")),
            light={"D": 1.0},
            camera={"components": [0.0]},
            reconstruction=photo,
            box=Box(0, 0, width, height),
            output_info=INFO,
            model={"version": "0"},
            uncertainty=Uncertainty(flat, flat, (0.1, 0.2), (1.0, 1.0)),
            colour_space=picture.colour_space,
            notes=picture.notes,
            faces_found=count,
        )
        return [replace(one, face_id=number + 1) for number in range(count)]

    def _edit(self, picture: Picture, *_: object, **__: object) -> Edited:
        """The picture with a red that is one level brighter or darker."""
        pixels = picture.as_colour().pixels.copy()
        _find_face(picture)
        pixels[..., 0] ^= 1
        means = ColourMeans(float(pixels[..., 0].size), np.zeros(3), np.ones(3))
        face = EditedFace(1, Box(0, 0, pixels.shape[1], pixels.shape[0]), means)
        return Edited(replace(picture.as_colour(), pixels=pixels), (face,), 1)


def _find_face(picture: Picture) -> None:
    if tuple(picture.srgb[0, 0]) == WALL:
        raise NoFaceError(f"No face was found in {picture.name}; try --whole-image.")


@pytest.fixture
def run(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> Callable[..., tuple[int, str, str]]:
    """Runs the command without a network, edits with a factor: exit code, output and messages."""
    monkeypatch.setattr("skinnet.inference._photo_verbs.Decomposer", FlatDecomposer)
    monkeypatch.setattr("skinnet.inference.results.draw_panel", lambda photo, _: photo)  # is slow

    def run(*arguments: object) -> tuple[int, str, str]:
        factor = ("--melanin", 2) if arguments[0] == "edit" else ()
        code = main([str(argument) for argument in (*arguments, *factor)])
        return code, *capsys.readouterr()

    return run


def paint(colour: tuple[int, int, int] = SKIN) -> Image.Image:
    """A picture that begins with a colour, and has other hues beside it."""
    pixels = np.full((16, 32, 3), colour, np.uint8)
    pixels[:, 16:24], pixels[:, 24:] = (60, 130, 70), (60, 80, 160)
    return Image.fromarray(pixels)


def save(
    path: Path, colour: tuple[int, int, int] = SKIN, format_: str = "", **options: Any
) -> Path:
    """Write such a picture, in the format of its name or another."""
    path.parent.mkdir(parents=True, exist_ok=True)
    paint(colour).save(path, format_ or None, **options)
    return path


def read_melanin(folder: Path) -> dict[str, float]:
    """Melanin of every summary in a folder, by its name."""
    found = {}
    for path in sorted(folder.glob("*.json")):
        summary = json.loads(path.read_text())
        found[path.name] = round(summary["maps"]["melanin"]["mean"], 3)
    return found


def names(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir())


def strip_marks(folder: Path, keep: tuple[str, ...] = ("map", "scale", "offset", "unit")) -> None:
    """Turn results into those of versions that had no marks."""
    for path in folder.glob("*.png"):
        if path.stem.endswith("_colour"):  # those versions wrote none
            path.unlink()
            continue
        with Image.open(path) as image:
            text = {key: value for key, value in image.text.items() if key in keep}
            array = np.array(image)
        write_png(path, array, text)
    for path in folder.glob("*.json"):
        summary = json.loads(path.read_text())
        for key in ("input", "notes", "colour_space"):
            summary.pop(key, None)
        path.write_text(json.dumps(summary))
