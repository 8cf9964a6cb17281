"""The files of a decomposed photograph, which are written together or not at all."""

import json
import math
import os
import re
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from skinnet.errors import InputError, _explain_fault
from skinnet.files import write_text, write_together
from skinnet.files._partial import write_aside
from skinnet.images._arguments import check_path, check_photo
from skinnet.images._mark import Mark
from skinnet.images._png_file import write_png
from skinnet.inference._colour_maps import (
    ColourMaps,
    describe_colour_maps,
    list_colour_maps,
    write_colour_map,
)
from skinnet.inference.decomposition import MAP_FILES, SKIN_THRESHOLD, Decomposition
from skinnet.inference.panel import draw_panel

_LEVELS, _SUMMARY = 65535, ".json"

_WRITERS, _STRIP = 2, 256
"""Files that are compressed at once, and rows that are quantised at once; both bound the memory."""

_PAIR_ON_LINES = re.compile(r"\[\n\s+([-+.\de]+),\n\s+([-+.\de]+)\n\s+\]")
"""Two numbers that JSON with an indent has on four lines; there are 478 such landmarks."""


class _Result(NamedTuple):
    """A decomposition, how the names of its files begin, and the content of its JSON file."""

    stem: str
    decomposition: Decomposition
    summary: dict[str, Any]


def write_results(
    folder: Path,
    stem: str,
    photo: NDArray[np.uint8],
    decomposition: Decomposition,
    summary: dict[str, Any],
    digest: str = "",
    *,
    colour_maps: ColourMaps = "pigments",
) -> int:
    """Write the panel, all maps, the reconstruction and the summary of a photograph.

    Maps are 16-bit PNG files in which value = scale * pixel + offset; their tEXt chunks hold
    `scale`, `offset` and `unit`. Apart from the mask itself they are 0 where the mask is not above
    0.5. Maps in colour, STEM_melanin_colour.png and so on, have the scales of the panel. All
    pictures carry a mark, so that they are not taken for photographs. Files of these names are
    replaced.

    Args:
        folder: Where to write; it is made if it does not exist.
        stem: How the files' names begin: STEM_panel.png, STEM_melanin.png, ..., STEM.json.
        photo: The photograph, uint8 sRGB [H, W, 3].
        decomposition: Its decomposition.
        summary: Content of the JSON file, usually `decomposition.to_dict()`.
        digest: SHA-256 of the photograph's file for the mark, in hexadecimals; "" if not known.
        colour_maps: Maps that are written in colour too: those of the "pigments", "all" (shading
            and specular reflection as well), or "none".

    Returns:
        The number of files.

    Raises:
        InputError: The folder cannot be written, or the photograph has another shape or type.

    Example:
        >>> from pathlib import Path
        >>> from tempfile import mkdtemp
        >>> from skimage.data import astronaut
        >>> from skinnet import Decomposer
        >>> from skinnet.inference import write_results
        >>> photo, folder = astronaut(), Path(mkdtemp())
        >>> decomposition = Decomposer()(photo, detail=False)
        >>> write_results(folder, "a", photo, decomposition, decomposition.to_dict())
        15
    """
    check_photo(photo)
    folder = check_path("The folder of results", folder)
    return _write_all(folder, [_Result(stem, decomposition, summary)], photo, digest, colour_maps)


def _write_all(
    folder: Path,
    results: Sequence[_Result],
    photo: NDArray[np.uint8],
    digest: str,
    colour_maps: ColourMaps = "pigments",
) -> int:
    """Write the results of a photograph, all or none. Returns the number of files of each."""
    _make_folder(folder)
    decompositions = [result.decomposition for result in results]
    with _write_pictures(folder, decompositions, photo, digest, colour_maps) as pictures:
        _name_files(folder, results, pictures)
    return len(_list_ends(colour_maps))


@contextmanager
def _write_pictures(
    folder: Path,
    decompositions: Sequence[Decomposition],
    photo: NDArray[np.uint8],
    digest: str,
    colour_maps: ColourMaps,
) -> Iterator[list[dict[str, Path]]]:
    """Write the pictures of a photograph under temporary names.

    They take the most time of what is written, and are the same whatever the photograph's results
    are called.

    Yields:
        For each decomposition the temporary paths by the ends of the names, such as `_panel.png`;
        those that are not renamed are removed at the end.
    """
    with write_aside(folder) as temporary:
        try:
            pictures = [
                _write_faces_pictures(each, photo, digest, colour_maps, temporary)
                for each in decompositions
            ]
        except OSError as error:
            raise _describe_fault(folder, error) from error
        yield pictures


def _write_faces_pictures(
    decomposition: Decomposition,
    photo: NDArray[np.uint8],
    digest: str,
    colour_maps: ColourMaps,
    temporary: Callable[[str], Path],
) -> dict[str, Path]:
    parts = {end: temporary(".png") for end in _list_ends(colour_maps) if end != _SUMMARY}
    pictures = {
        "reconstruction": decomposition.reconstruction,
        "panel": draw_panel(photo, decomposition),
    }
    jobs = [
        partial(write_png, parts[f"_{name}.png"], picture, Mark("predict", name, digest).to_text())
        for name, picture in pictures.items()
    ]
    mark = Mark("predict", "map", digest)
    jobs += [
        partial(_write_map, parts[f"_{name}.png"], name, decomposition, mark) for name in MAP_FILES
    ]
    jobs += [
        partial(write_colour_map, parts[f"_{name}_colour.png"], name, decomposition, digest)
        for name in list_colour_maps(colour_maps)
    ]
    with ThreadPoolExecutor(_WRITERS) as pool:
        for job in [pool.submit(job) for job in jobs]:
            job.result()
    return parts


def _name_files(
    folder: Path, results: Sequence[_Result], pictures: Sequence[dict[str, Path]]
) -> None:
    """Give the pictures of a photograph their names, and write its summaries, all or none."""
    try:
        with write_together() as temporary:
            for (stem, _, summary), parts in zip(results, pictures, strict=True):
                for end, part in parts.items():
                    os.replace(part, temporary(folder / f"{stem}{end}"))
                record = json.dumps(summary, indent=2, allow_nan=False)
                record = _PAIR_ON_LINES.sub(r"[\1, \2]", record)
                write_text(temporary(folder / f"{stem}{_SUMMARY}"), record + "\n")
    except OSError as error:
        raise _describe_fault(folder, error) from error


def _make_folder(folder: Path) -> Path:
    """Make the folder of results if it does not exist."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise _describe_fault(folder, error) from error
    return folder


def _describe_fault(folder: Path, error: OSError) -> InputError:
    return InputError(
        f"{folder} cannot be written {_explain_fault(error, 'choose another folder with -o')}."
    )


def _name_part(decomposition: Decomposition, count: int) -> str:
    """What the names of a face's files have after the photograph's, if it is one of several."""
    return f"_face{decomposition.face_id}" if count > 1 else ""


def _list_all_ends(
    decompositions: Sequence[Decomposition], colour_maps: ColourMaps = "pigments"
) -> list[str]:
    """List the ends of the names of all files of a photograph."""
    return [
        _name_part(each, len(decompositions)) + end
        for each in decompositions
        for end in _list_ends(colour_maps)
    ]


def _list_ends(colour_maps: ColourMaps) -> list[str]:
    """List the ends of the names of the files that `write_results` writes."""
    coloured = (f"{name}_colour" for name in list_colour_maps(colour_maps))
    names = ("panel", "reconstruction", *MAP_FILES, *coloured)
    return [*(f"_{name}.png" for name in names), _SUMMARY]


def _describe_map_files(colour_maps: ColourMaps) -> dict[str, Any]:
    """Describe what the files of maps hold, for JSON."""
    return {
        "outside_mask": 0.0,
        "mask_above": SKIN_THRESHOLD,
        "colour": describe_colour_maps(colour_maps),
    }


def _write_map(path: Path, name: str, decomposition: Decomposition, mark: Mark) -> None:
    """Write a map of 16 bits, which is 0 outside of the mask; the mask itself is written whole."""
    info, values = decomposition.describe_map(name), decomposition.get_map(name)
    skin = None if name == "mask" else decomposition.mask > SKIN_THRESHOLD
    inside = values if skin is None else values[skin]
    low = min(info.range[0], float(inside.min(initial=0)))
    scale, low = _fit_levels(low, max(info.range[1], float(inside.max(initial=0))))
    pixels = _quantise(values, skin, low, scale)
    text = {"scale": repr(scale), "offset": repr(low), "unit": info.unit}
    if skin is not None:
        text["outside_mask"] = f"0: the map is 0 where the mask is not above {SKIN_THRESHOLD:g}"
    text = {"Description": info.description, "map": name} | text | mark.to_text()
    write_png(path, pixels, text)


def _fit_levels(low: float, high: float) -> tuple[float, float]:
    """The step of the levels, and the value of the first; one of the levels is exactly 0."""
    if low >= 0:
        return (high - low) / _LEVELS or 1.0, low
    step = (high - low) / (_LEVELS - 1)
    return step, -step * math.ceil(-low / step)


def _quantise(
    values: NDArray[np.float32], skin: NDArray[np.bool_] | None, low: float, scale: float
) -> NDArray[np.uint16]:
    pixels = np.empty(values.shape, np.uint16)
    for top in range(0, values.shape[0], _STRIP):
        rows = slice(top, top + _STRIP)
        kept = values[rows] if skin is None else np.where(skin[rows], values[rows], 0)
        pixels[rows] = np.rint((kept - low) / scale).clip(0, _LEVELS)
    return pixels
