"""The files of one decomposed photograph, which are written together or not at all."""

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

_PICTURE_SUFFIXES = (".png", ".jpg", ".jpeg")
"""Suffixes with which an edited photograph is written."""

_LEVELS = 65535


def write_results(
    folder: Path,
    stem: str,
    photo: NDArray[np.uint8],
    decomposition: Decomposition,
    summary: dict[str, Any],
) -> int:
    """Write the panel, all maps, the reconstruction and the summary of a photograph.

    Maps are 16-bit PNG files in which value = scale * pixel + offset; their tEXt chunks hold
    `scale`, `offset` and `unit`.

    Args:
        folder: Where to write; it is made if it does not exist.
        stem: How the files' names begin: STEM_panel.png, STEM_melanin.png, ..., STEM.json.
        photo: The photograph, uint8 sRGB [H, W, 3].
        decomposition: Its decomposition.
        summary: Content of the JSON file, usually `decomposition.summary()`.

    Returns:
        The number of files.

    Raises:
        InputError: The folder cannot be written.

    Example:
        >>> from pathlib import Path
        >>> from tempfile import mkdtemp
        >>> from skimage.data import astronaut
        >>> from skinnet import Decomposer
        >>> from skinnet.inference import write_results
        >>> photo, folder = astronaut(), Path(mkdtemp())
        >>> decomposition = Decomposer()(photo, detail=False)
        >>> write_results(folder, "a", photo, decomposition, decomposition.summary())
        11
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with write_together() as temporary:
            panel = draw_panel(photo, decomposition)
            write_png(temporary(folder / f"{stem}_panel.png"), panel)
            reconstruction = temporary(folder / f"{stem}_reconstruction.png")
            write_png(reconstruction, decomposition.reconstruction)
            for name, values in decomposition.maps().items():
                _write_map(temporary(folder / f"{stem}_{name}.png"), name, values, decomposition)
            text = json.dumps(summary, indent=2, allow_nan=False)
            write_text(temporary(folder / f"{stem}.json"), text + "\n")
    except OSError as error:
        raise InputError(
            f"{folder} cannot be written ({error.strerror}); choose another folder with -o."
        ) from error
    return len(decomposition.maps()) + 3


def _write_picture(path: Path, photo: NDArray[np.uint8]) -> None:
    """Write uint8 sRGB [H, W, 3] as PNG or JPEG, by the suffix."""
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
    if path.suffix.lower() not in _PICTURE_SUFFIXES:
        raise InputError(
            f"{path} has to end in {', '.join(_PICTURE_SUFFIXES)}; got {path.suffix!r}."
        )


def _write_map(
    path: Path, name: str, values: NDArray[np.float32], decomposition: Decomposition
) -> None:
    info = decomposition.describe_map(name)
    low = min(info.range[0], float(values.min()))
    high = max(info.range[1], float(values.max()))
    scale = (high - low) / _LEVELS or 1.0
    pixels = np.rint((values - low) / scale).clip(0, _LEVELS).astype(np.uint16)
    text = {"scale": repr(scale), "offset": repr(low), "unit": info.unit}
    write_png(path, pixels, {"Description": info.description, "map": name} | text)
