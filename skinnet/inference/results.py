"""The files of one decomposed photograph, which appear together or not at all."""

import json
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from skinnet.errors import InputError
from skinnet.files import write_atomically, write_text, write_together
from skinnet.images.photograph import write_png
from skinnet.inference.decomposition import Decomposition
from skinnet.inference.panel import draw_panel

PICTURES = (".png", ".jpg", ".jpeg")
"""Suffixes under which an edited photograph is written."""

_LEVELS = 65535


def write_results(
    folder: Path,
    stem: str,
    photo: NDArray[np.uint8],
    decomposition: Decomposition,
    summary: dict[str, Any],
) -> int:
    """Write panel, maps, reconstruction and summary into `folder`, made if needed; count them.

    Files are named STEM_melanin.png and so on, and STEM.json. Raises `InputError` if the folder
    cannot be written.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with write_together() as beside:
            write_png(beside(folder / f"{stem}_panel.png"), draw_panel(photo, decomposition))
            picture = decomposition.reconstruction
            write_png(beside(folder / f"{stem}_reconstruction.png"), picture)
            for name, values in decomposition.maps().items():
                _write_map(beside(folder / f"{stem}_{name}.png"), name, values, decomposition)
            text = json.dumps(summary, indent=2, allow_nan=False)
            write_text(beside(folder / f"{stem}.json"), text + "\n")
    except OSError as error:
        raise InputError(
            f"{folder} cannot be written ({error.strerror}); choose another folder with -o."
        ) from error
    return len(decomposition.maps()) + 3


def _write_picture(path: Path, photo: NDArray[np.uint8]) -> None:
    """Write uint8 sRGB [H, W, 3] as PNG or JPEG, by the suffix, atomically.

    Raises `InputError` for another suffix, and where the file cannot be written.
    """
    _check_suffix(path)
    try:
        if path.suffix.lower() == ".png":
            write_png(path, photo)
        else:
            with write_atomically(path) as part:
                Image.fromarray(photo).save(part, "JPEG", quality=95, subsampling=0)
    except OSError as error:
        raise InputError(
            f"{path} cannot be written ({error.strerror}); choose another file with -o."
        ) from error


def _check_suffix(path: Path) -> None:
    """Raise `InputError` unless the suffix is that of a picture that can be written."""
    if path.suffix.lower() not in PICTURES:
        raise InputError(f"{path} has to end in {', '.join(PICTURES)}; got {path.suffix!r}.")


def _write_map(
    path: Path, name: str, values: NDArray[np.float32], decomposition: Decomposition
) -> None:
    """A 16-bit PNG in which value = scale * pixel + offset; its text says scale, offset, unit."""
    output = decomposition.describe_map(name)
    low = min(output.range[0], float(values.min()))
    high = max(output.range[1], float(values.max()))
    scale = (high - low) / _LEVELS or 1.0
    pixels = np.rint((values - low) / scale).clip(0, _LEVELS).astype(np.uint16)
    note = {"scale": repr(scale), "offset": repr(low), "unit": output.unit}
    write_png(path, pixels, {"Description": output.description, "map": name} | note)
