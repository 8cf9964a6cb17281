"""What the command prints: results to standard output, all else to standard error."""

import os
import re
import signal
import sys
import threading
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from enum import IntEnum
from typing import NamedTuple

from skinnet.errors import _explain_fault
from skinnet.files._partial import take_removed

_CONTROL = re.compile("[\0-\x08\x0b-\x1f\x7f-\x9f\u200e\u200f\u202a-\u202e\u2066-\u2069]")
"""Control characters of C0 and C1, apart from tabs and line ends, and those that turn text."""


def open_missing_streams() -> None:
    """Open the null device in place of standard streams that the caller has closed.

    Else the next file that is opened would get the number of one of them, and what a library prints
    would be written into it.
    """
    for number, name in enumerate(("stdin", "stdout", "stderr")):
        if getattr(sys, name) is not None:
            continue
        try:
            os.fstat(number)
        except OSError:
            null = os.open(os.devnull, os.O_RDWR)
            if null != number:
                os.dup2(null, number)
                os.close(null)
        setattr(sys, name, open(number, "r" if number == 0 else "w", closefd=False))


@contextmanager
def quit_at_interrupt() -> Iterator[None]:
    """End the process at Ctrl-C while libraries are imported and nothing is written yet.

    Libraries turn a `KeyboardInterrupt` in the middle of their import into errors of their own.
    """
    usual = signal.getsignal(signal.SIGINT) is signal.default_int_handler
    if not usual or threading.current_thread() is not threading.main_thread():
        yield
        return
    signal.signal(signal.SIGINT, lambda *_: os._exit(130))
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, signal.default_int_handler)


class Verbosity(IntEnum):
    """How much the command says beside results and errors, which it always prints."""

    QUIET = 0
    USUAL = 1
    VERBOSE = 2


_level = Verbosity.USUAL


@contextmanager
def keep_verbosity() -> Iterator[None]:
    """Set how much is said back at the end of a block to what it was before."""
    before = _level
    try:
        yield
    finally:
        set_verbosity(before)


def set_verbosity(level: Verbosity) -> None:
    """Set how much is said, in all threads."""
    global _level
    _level = level


def get_verbosity() -> Verbosity:
    """How much is said now; progress is for `Verbosity.USUAL` and more."""
    return _level


class Line(NamedTuple):
    """A line that is to be printed: its text, and whether it is a result."""

    text: str
    is_result: bool


_recorded: list[Line] | None = None


@contextmanager
def record_lines() -> Iterator[list[Line]]:
    """Keep lines instead of printing them, so that another process prints them.

    Yields:
        The lines so far.
    """
    global _recorded
    _recorded = []
    try:
        yield _recorded
    finally:
        _recorded = None


def print_recorded(lines: Iterable[Line]) -> None:
    """Print lines that were kept, each where it belongs."""
    for text, is_result in lines:
        if is_result:
            print_line(text)
        else:
            _print_error(text)


def print_line(text: str) -> None:
    """Print a result: what was asked for."""
    if _recorded is not None:
        _recorded.append(Line(text, True))
    else:
        print(_escape(text, sys.stdout.encoding), flush=True)


def note(sentence: str, program: str = "skinnet") -> None:
    """Print what the user should know, unless --quiet is given."""
    if _level >= Verbosity.USUAL:
        _print_error(_make_line(f"{program}: {sentence}"))


def explain(sentence: str) -> None:
    """Print what was assumed, how long something took, and the like, if --verbose is given."""
    if _level >= Verbosity.VERBOSE:
        _print_error(f"skinnet: {sentence}")


def log(line: str) -> None:
    """Print a line on the progress of long work, unless --quiet is given."""
    if _level >= Verbosity.USUAL:
        _print_error(line)


def report(error: Exception, program: str = "skinnet") -> None:
    """Print an error as a sentence, always."""
    _print_error(_make_line(f"{program}: {describe(error)}"))


def note_removed() -> None:
    """Print which partial files were removed, if any were."""
    removed = take_removed()
    if removed:
        folders = ", ".join(dict.fromkeys(str(path.parent) for path in removed))
        note(f"{len(removed)} partial files of an interrupted run were removed from {folders}.")


def describe(error: Exception) -> str:
    """Describe an error in a sentence."""
    if isinstance(error, OSError):
        return f"{error.filename or 'A file'} cannot be used {_explain_fault(error)}."
    return str(error)


def _print_error(line: str) -> None:
    if _recorded is not None:
        _recorded.append(Line(line, False))
    else:
        print(_escape(line, sys.stderr.encoding), file=sys.stderr, flush=True)


def _make_line(sentence: str) -> str:
    """Escape the line ends that a sentence has from the name of a file."""
    return sentence.replace("\n", "\\n").replace("\t", "\\t")


def _escape(text: str, encoding: str | None) -> str:
    """Replace characters that an encoding does not have, and that control a terminal, by escapes.

    The name of a file may hold them, and change what a terminal shows and does.
    """
    encoding = encoding or "utf-8"
    text = _CONTROL.sub(lambda found: ascii(found[0])[1:-1], text)
    return text.encode(encoding, "backslashreplace").decode(encoding)
