"""How far a run over many files is: a bar on a terminal, else a line a minute."""

import shutil
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, redirect_stderr, redirect_stdout
from typing import TYPE_CHECKING, Any, TextIO, cast

from skinnet.inference._messages import Verbosity, get_verbosity, note

if TYPE_CHECKING:
    from tqdm import tqdm

Advance = Callable[[int], None]
"""Say that one more file is done, and how many have failed so far."""

_BAR = "{n_fmt} of {total_fmt} |{bar:24}| {rate_noinv_fmt}, {remaining} left{postfix}"

_WIDEST = 100
"""Columns of the bar at most."""

_EVERY = 60.0
"""Seconds between two lines where standard error is no terminal."""


@contextmanager
def show_progress(total: int, quiet: bool = False) -> Iterator[Advance]:
    """Show how far a run is; what is printed meanwhile stands above the bar.

    Args:
        total: Number of files.
        quiet: Whether to show nothing, as with --quiet.

    Yields:
        A function to call after each file.
    """
    if quiet or total < 2 or get_verbosity() < Verbosity.USUAL:
        yield lambda failed: None
    elif _is_terminal(sys.stderr) and sys.stdout is not None:
        with _draw_bar(total) as advance:
            yield advance
    else:
        yield _Lines(total).advance


def _is_terminal(stream: Any) -> bool:
    return stream is not None and stream.isatty()  # it is None where it was closed


@contextmanager
def _draw_bar(total: int) -> Iterator[Advance]:
    from tqdm import tqdm  # here, since it takes a twentieth of a second

    # tqdm itself shows nothing on a terminal that does not know its size.
    width = min(shutil.get_terminal_size().columns, _WIDEST)
    size = {"ncols": width, "nrows": 20}
    words = {"bar_format": _BAR, "unit": " photographs", "leave": False}
    with tqdm(total=total, file=sys.stderr, **size, **words) as bar:
        out, err = (_AboveBar(stream, bar) for stream in (sys.stdout, sys.stderr))
        with redirect_stdout(cast(TextIO, out)), redirect_stderr(cast(TextIO, err)):
            yield lambda failed: _advance(bar, failed)


def _advance(bar: "tqdm[Any]", failed: int) -> None:
    if failed:
        bar.set_postfix_str(f"{failed} failed", refresh=False)
    bar.update()


class _AboveBar:
    """A stream whose whole lines are written above a bar."""

    def __init__(self, stream: Any, bar: "tqdm[Any]") -> None:
        self._stream, self._bar, self._rest = stream, bar, ""

    def __getattr__(self, name: str) -> Any:
        return getattr(self._stream, name)

    def write(self, text: str) -> int:
        """Write text; the part after the last end of a line waits for the next one."""
        lines, end, self._rest = (self._rest + text).rpartition("\n")
        if end:
            with self._bar.external_write_mode(file=self._bar.fp):
                self._stream.write(lines + end)
                self._stream.flush()
        return len(text)


class _Lines:
    """A plain line now and then."""

    def __init__(self, total: int) -> None:
        self._total, self._done = total, 0
        self._start = self._last = time.monotonic()

    def advance(self, failed: int) -> None:
        """Count a file, and print a line if the last one is long ago."""
        self._done += 1
        now = time.monotonic()
        if now - self._last < _EVERY or self._done == self._total:
            return
        self._last = now
        rate = self._done / (now - self._start)
        minutes = (self._total - self._done) / rate / 60
        note(
            f"{self._done} of {self._total} done, {failed} failed, {rate:.2g} per second, about "
            f"{max(minutes, 1):.0f} min left."
        )
