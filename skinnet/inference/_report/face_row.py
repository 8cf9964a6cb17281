"""A face as a row of the report: small pictures, numbers with intervals, and notes."""

import os
import re
from base64 import b64encode
from collections.abc import Mapping, Sequence
from html import escape
from io import BytesIO
from pathlib import Path
from typing import Any, NamedTuple
from urllib.parse import quote

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from skinnet.images.resizing import resize
from skinnet.inference._colour_scales import PIGMENTS, SHADING
from skinnet.inference._tiles import colour_small_map
from skinnet.inference.decomposition import Decomposition

_SIZE = 144
"""Longer side of a picture, in pixels."""

_QUALITY = 80
_CONTROLS = re.compile(r"[\x00-\x1f\x7f-\x9f]")


class Column(NamedTuple):
    """A column: its title, and whether rows are sorted by it, as numbers or as text."""

    title: str
    kind: str = ""


COLUMNS = (
    Column("Face", "text"),
    *map(Column, ("Photograph", "Melanin map", "Hemoglobin map", "Shading map")),
    *(Column(title, "number") for title in ("Melanin", "Hemoglobin", "Typology angle", "Skin")),
    Column("Notes", "number"),
)


def make_row(
    photo: NDArray[np.uint8],
    decomposition: Decomposition,
    summary: Mapping[str, Any],
    panel: Path,
    folder: Path,
) -> str:
    """Make the row of a face.

    Args:
        photo: The photograph, uint8 sRGB [H, W, 3].
        decomposition: What was read of it.
        summary: Its summary, with the name of the file.
        panel: The panel that was written, to which the row links.
        folder: The folder of the report.

    Returns:
        An element `tr`, in which every text is escaped.
    """
    name = show_text(summary["file"])
    cells = [
        _make_head(name, summary, panel, folder),
        *_draw_pictures(photo, decomposition, name),
        *(_make_pigment(title, summary["pigments"][title.lower()]) for title in _TITLES),
        _make_angle(summary["indices"]),
        _make_share(summary["skin_share"]),
        _make_notes(summary["notes"]),
    ]
    return f'<tr role="row">{"".join(cells)}</tr>\n'


_TITLES = ("Melanin", "Hemoglobin")


def show_text(text: object) -> str:
    """Escape a text for HTML; control characters and bytes that are no text become visible."""
    plain = str(text).encode("utf-8", "backslashreplace").decode("utf-8")
    return escape(_CONTROLS.sub(lambda found: f"\\x{ord(found[0]):02x}", plain), quote=True)


def embed_picture(pixels: NDArray[np.uint8], alt: str) -> str:
    """An element `img` that holds a picture, uint8 sRGB [h, w, 3]; `alt` is escaped already."""
    buffer = BytesIO()
    Image.fromarray(pixels).save(buffer, "WEBP", quality=_QUALITY, method=4)
    data = b64encode(buffer.getvalue()).decode("ascii")
    height, width = pixels.shape[:2]
    size = f'width="{width}" height="{height}"'
    return f'<img src="data:image/webp;base64,{data}" alt="{alt}" {size} decoding="async">'


def _make_head(name: str, summary: Mapping[str, Any], panel: Path, folder: Path) -> str:
    found, number = summary["faces_found"], summary["id"]
    several = f"<br><small>face {number} of {found}</small>" if (found or 0) > 1 else ""
    link = show_text("./" + quote(_find_path(panel, folder), errors="surrogateescape"))
    words = f'<a href="{link}">panel<span class="unseen"> of {name}</span></a>'
    value = f"{name} {number or 0:05d}"
    return (
        f'<th scope="row" role="rowheader" data-value="{value}">{_show_file(summary)}{several}'
        f"<br><small>{words}</small></th>"
    )


def _show_file(summary: Mapping[str, Any]) -> str:
    """The name of a file, and its folder in small letters."""
    folder, name = os.path.split(summary["file"])
    small = f"<br><small><bdi>{show_text(folder)}</bdi></small>" if folder and name else ""
    return f"<bdi>{show_text(name or folder)}</bdi>{small}"


def _find_path(file: Path, folder: Path) -> str:
    """The path of a file from a folder; on another drive of Windows its name alone."""
    try:
        return Path(os.path.relpath(file, folder)).as_posix()
    except ValueError:
        return file.name


def _draw_pictures(photo: NDArray[np.uint8], decomposition: Decomposition, name: str) -> list[str]:
    box = decomposition.box
    size = _fit(box.width, box.height)
    mask = decomposition.mask[box.slices]
    scales = {**PIGMENTS, "shading": SHADING}
    pictures = {"photograph": resize(np.ascontiguousarray(photo[box.slices]), *size)}
    for each, scale in scales.items():
        values = getattr(decomposition, each)[box.slices]
        pictures[each] = colour_small_map(values, mask, scale, *size)
    titles = [column.title for column in COLUMNS[1:5]]
    return [
        f'<td role="cell" data-label="{title}">{embed_picture(pixels, f"{part} of {name}")}</td>'
        for title, (part, pixels) in zip(titles, pictures.items(), strict=True)
    ]


def _fit(width: int, height: int) -> tuple[int, int]:
    scale = _SIZE / max(width, height)
    return max(1, round(width * scale)), max(1, round(height * scale))


def _make_pigment(title: str, pigment: Mapping[str, Any]) -> str:
    mean = pigment["mean"]
    if mean is None:
        return _make_number(title, "", "no skin")
    low, high = (f"{100 * end:.2g}" for end in pigment["interval"])
    words = f"<strong>{100 * mean:.2g} %</strong><small>90 %: {low} to {high} %</small>"
    return _make_number(title, f"{mean:.6g}", words)


def _make_angle(indices: Mapping[str, Any] | None) -> str:
    angle = None if indices is None else indices["typology_angle"]
    if angle is None or angle["value"] is None:
        return _make_number("Typology angle", "", "not known")
    low, high = (f"{end:.0f}" for end in angle["interval"])
    words = f"<strong>{angle['value']:.0f}°</strong><small>90 %: {low} to {high}°</small>"
    return _make_number("Typology angle", f"{angle['value']:.6g}", words)


def _make_share(share: float) -> str:
    return _make_number("Skin", f"{share:.6g}", f"{100 * share:.2g} %")


def _make_number(title: str, value: str, words: str) -> str:
    attributes = f'class="number" data-label="{title}" data-value="{value}"'
    return f'<td role="cell" {attributes}>{words}</td>'


def _make_notes(notes: Sequence[str]) -> str:
    items = "".join(f"<li>{show_text(note)}</li>" for note in notes)
    words = f"<ul>{items}</ul>" if items else "none"
    attributes = f'class="notes" data-label="Notes" data-value="{len(notes)}"'
    return f'<td role="cell" {attributes}>{words}</td>'
