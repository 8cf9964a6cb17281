"""The report of a run, one page of HTML that needs no other file."""

import os
import shutil
from base64 import b64encode
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from hashlib import sha256
from html import escape
from importlib.resources import files
from pathlib import Path
from tempfile import SpooledTemporaryFile
from typing import IO

import numpy as np
from numpy.typing import NDArray

from skinnet._version import __version__
from skinnet.errors import InputError
from skinnet.files import write_atomically
from skinnet.inference._colour_scales import HEMOGLOBIN, MELANIN, SHADING
from skinnet.inference._messages import note
from skinnet.inference._report.face_row import COLUMNS, embed_picture, make_row, show_text
from skinnet.inference._tiles import draw_scale
from skinnet.inference._usual_values import describe_usual
from skinnet.inference.results import _describe_fault, _make_folder, _Result

NAME = "report.html"
"""Name of a report that the user has not named."""

_SUFFIXES = (".html", ".htm")
_GENERATOR = '<meta name="generator" content="skinnet '
_HEAD, _IN_MEMORY = 2048, 1 << 23
"""Bytes in which a report names its maker, and bytes of rows that are kept in memory."""

_SCALES = {"melanin": MELANIN, "hemoglobin": HEMOGLOBIN, "shading": SHADING}


class FaceReport:
    """A page of HTML that takes the faces of a run one by one, or nothing if none was asked for.

    Rows wait in a temporary file, so that memory does not grow with their number; the page is
    written at the end, completely or not at all.

    Args:
        path: The page; None for none.

    Raises:
        InputError: The path does not end in .html, is no report of skinnet, or cannot be written.
    """

    def __init__(self, path: Path | None) -> None:
        self.path = path
        self._count = 0
        self._failures: list[tuple[str, str]] = []
        self._rows: IO[bytes] | None = None
        if path is not None:
            _check_path(path)
            self._rows = SpooledTemporaryFile(_IN_MEMORY)  # closed by finish

    def add_rows(self, rows: Iterable[str]) -> None:
        """Add the rows of a photograph, which `make_rows` makes.

        Raises:
            InputError: There is no room for them.
        """
        if self._rows is None:
            return
        for row in rows:
            try:
                self._rows.write(row.encode("utf-8"))
            except OSError as error:
                raise InputError(
                    f"The rows of {self.path} cannot be kept in the folder of temporary files "
                    f"({error.strerror}); make room there, or set TMPDIR to another folder."
                ) from error
            self._count += 1

    def add_failure(self, name: str, reason: str) -> None:
        """Add a file that was not read."""
        if self.path is not None:
            self._failures.append((name, reason))

    @contextmanager
    def finish_at_interrupt(self) -> Iterator[None]:
        """Write what there is, and say so, if Ctrl-C ends the block."""
        try:
            yield
        except KeyboardInterrupt:
            if self.path is not None:
                self.finish("The run was interrupted. The photographs that were left are not here.")
                note(f"Interrupted. {self.path} has the {self._count} faces that were read.")
            raise

    def finish(self, total: str) -> None:
        """Write the page.

        Args:
            total: What the run says at its end.

        Raises:
            InputError: The page cannot be written.
        """
        if self.path is None or self._rows is None:
            return
        _make_folder(self.path.parent)
        self._rows.seek(0)
        try:
            with write_atomically(self.path) as part, part.open("wb") as file:
                file.write(self._make_start(total).encode("utf-8"))
                shutil.copyfileobj(self._rows, file)
                file.write(self._make_end().encode("utf-8"))
        except OSError as error:
            raise _describe_fault(self.path.parent, error) from error
        finally:
            self._rows.close()

    def _make_start(self, total: str) -> str:
        return (
            f"{_make_head(self._count)}<body>\n<main>\n<h1>Melanin and hemoglobin of "
            f"{self._count} face{'s' * (self._count != 1)}</h1>\n<p>{show_text(total)}</p>\n"
            f"{_EXPLANATION}{_draw_scales()}{_make_sorting()}{_make_table_head()}"
        )

    def _make_end(self) -> str:
        rows = "".join(
            f"<tr><td><bdi>{show_text(name)}</bdi></td><td>{show_text(reason)}</td></tr>\n"
            for name, reason in self._failures
        )
        failures = (
            "<h2>Files that were not read</h2>\n"
            '<table id="failures"><thead><tr><th scope="col">File</th><th scope="col">Why</th></tr>'
            f"</thead><tbody>\n{rows}</tbody></table>\n"
            if rows
            else "<p>All files were read.</p>\n"
        )
        return (
            f"</tbody></table>\n{failures}<p><small>Made by skinnet {__version__}. The "
            "photographs are in this page: whoever has it sees them.</small></p>\n</main>\n"
            f"<script>{_SCRIPT}</script>\n</body>\n</html>\n"
        )


def make_rows(
    photo: NDArray[np.uint8], results: Sequence[_Result], folder: Path, page: Path
) -> list[str]:
    """Make a row of a report for each face of a photograph.

    Args:
        photo: The photograph, uint8 sRGB [H, W, 3].
        results: What was read and written.
        folder: Where it was written.
        page: The page.

    Returns:
        Elements `tr`.
    """
    return [
        make_row(photo, each, summary, folder / f"{stem}_panel.png", page.parent)
        for stem, each, summary in results
    ]


def _check_path(path: Path) -> None:
    if path.suffix.lower() not in _SUFFIXES:
        raise InputError(
            f"--report is a page that ends in .html; got {path}. Give --report after the "
            "photographs for a page of the usual name."
        )
    if path.is_dir():
        raise InputError(f"{path} is a folder; choose another file with --report.")
    if os.path.lexists(path) and not _is_report(path):
        raise InputError(
            f"{path} exists, and is not a report of skinnet; choose another file with --report, or "
            "remove it."
        )
    folder = next((each for each in path.absolute().parents if each.exists()), path.absolute())
    if not os.access(folder, os.W_OK):
        raise InputError(f"{folder} cannot be written; choose another file with --report.")


def _is_report(path: Path) -> bool:
    try:
        with path.open("rb") as file:
            return _GENERATOR.encode("ascii") in file.read(_HEAD)
    except OSError:
        return False


def _read(name: str) -> str:
    return files("skinnet.inference._report").joinpath(name).read_text(encoding="utf-8")


_STYLE, _SCRIPT = f"\n{_read('report.css')}", f"\n{_read('report.js')}"

_EXPLANATION = (
    "<p>Each number is the mean over the skin of a face, with the interval that holds the true "
    "value in about nine of ten photographs. Melanin is the share of melanosomes in the volume of "
    f"the epidermis (usual: {describe_usual('melanin')}), hemoglobin that of blood in the dermis "
    f"(usual: {describe_usual('hemoglobin')}). Numbers whose intervals overlap are not known to "
    "differ. They are not for diagnosis, and not for judging where a person comes from.</p>\n"
)


def _make_head(count: int) -> str:
    """The head; its policy lets nothing run or load but what is written here."""
    policy = (
        "default-src 'none'; img-src data:; base-uri 'none'; form-action 'none'; "
        f"style-src '{_hash(_STYLE)}'; script-src '{_hash(_SCRIPT)}'"
    )
    return (
        '<!DOCTYPE html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        f'{_GENERATOR}{__version__} report">\n'
        f'<meta http-equiv="Content-Security-Policy" content="{policy}">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        '<meta name="color-scheme" content="light dark">\n'
        f"<title>skinnet: {count} face{'s' * (count != 1)}</title>\n<style>{_STYLE}</style>\n"
        "</head>\n"
    )


def _hash(text: str) -> str:
    return f"sha256-{b64encode(sha256(text.encode('utf-8')).digest()).decode('ascii')}"


def _draw_scales() -> str:
    figures = (
        f"<figure>{embed_picture(draw_scale(scale), f'Colour scale of {name}, in percent')}"
        f"<figcaption><small>{name}</small></figcaption></figure>"
        for name, scale in _SCALES.items()
    )
    return f'<div class="scales">{"".join(figures)}</div>\n'


def _make_sorting() -> str:
    options = "".join(
        f'<option value="{index}">{escape(column.title)}</option>'
        for index, column in enumerate(COLUMNS)
        if column.kind
    )
    return (
        '<div class="sorting" id="sorting" hidden><label for="by">Sort by</label>'
        f'<select id="by">{options}</select>'
        '<button type="button" id="turn">Ascending</button>'
        '<span id="told" role="status" class="soft"></span></div>\n'
    )


def _make_table_head() -> str:
    heads = "".join(_make_title(*column) for column in COLUMNS)
    return (
        '<table id="faces" role="table"><caption>A row for each face</caption>\n'
        f'<thead role="rowgroup"><tr role="row">{heads}</tr></thead>\n'
        '<tbody role="rowgroup">\n'
    )


def _make_title(title: str, kind: str) -> str:
    start = f'<th scope="col" role="columnheader" data-kind="{kind}"'
    if not kind:
        return f"{start}>{title}</th>"
    return f'{start} aria-sort="none"><button type="button">{title}</button></th>'
