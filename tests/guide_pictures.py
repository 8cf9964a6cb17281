"""The files that the commands and the code of the guide are about."""

import shutil
from pathlib import Path

import numpy as np
import raw_files
from PIL import Image
from skimage.data import astronaut

from benchmarks.chart_pictures import View, photograph
from skinnet.images import srgb_to_linear

CARD = np.s_[50:100, 390:450]
"""Where the photograph shows a grey card."""

CHEEK = 135, 200
"""Row and column of a cheek in the photograph."""


def write_pictures(folder: Path) -> None:
    """Write a photograph with a grey card, a chart, a RAW file, and shots in several lights."""
    photo = astronaut()
    _save(photo, folder / "before.jpg")
    _save(photo[:, 4:], folder / "after.jpg")
    photo[CARD] = 180
    _save(photo, folder / "photo.jpg")
    _save(paint_mask(photo.shape), folder / "cheek.png")
    view = View("D55", 3, tilt=20, axis=40, roll=8, exposure=0.55, contrast=0.14, bend=0.5)
    _save(photograph(view), folder / "chart.jpg")
    raw = raw_files.photograph_picture(srgb_to_linear(astronaut()), "Nikon D700")
    (folder / "portrait.dng").write_bytes(raw)
    for name in ("session", "folder", "photographs"):
        (folder / name).mkdir()
    for name, gain in {"a": (1, 1, 1), "b": (1.06, 1, 0.9), "c": (0.95, 1, 1.08)}.items():
        shot = (photo[:300, :400] * np.array(gain)).clip(0, 255).astype(np.uint8)
        _save(shot, folder / f"{name}.jpg")
        for copies in ("session", "photographs"):
            shutil.copy(folder / f"{name}.jpg", folder / copies)
    shutil.copy(folder / "photo.jpg", folder / "folder")
    shutil.copytree(folder / "session", folder / "photos")


def paint_mask(shape: tuple[int, ...]) -> np.ndarray:
    """A white disc with a soft edge on a cheek, uint8 [H, W]."""
    rows, columns = np.mgrid[: shape[0], : shape[1]]
    distance = np.hypot(rows - CHEEK[0], columns - CHEEK[1])
    return (255 * (1.5 - distance / 12).clip(0, 1)).astype(np.uint8)


def _save(picture: np.ndarray, path: Path) -> None:
    Image.fromarray(np.ascontiguousarray(picture)).save(path, quality=95)
