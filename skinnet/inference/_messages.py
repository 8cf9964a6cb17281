"""What the command prints: results to standard output, all else to standard error."""

import os
import re
import signal
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager

from skinnet.errors import _explain_fault
from skinnet.files._partial import take_removed

_CONTROL = re.compile("[\0-\x1f\x7f-\x9f\u200e\u200f\u202a-\u202e\u2066-\u2069]")
"""Control characters of C0 and C1, and those that turn the direction of text."""


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


def print_line(text: str) -> None:
    """Print a result."""
    print(_escape(text, sys.stdout.encoding), flush=True)


def note(sentence: str, program: str = "skinnet") -> None:
    """Print what the user should know."""
    log(f"{program}: {sentence}")


def log(line: str) -> None:
    """Print a line to standard error."""
    print(_escape(line, sys.stderr.encoding), file=sys.stderr, flush=True)


def report(error: Exception, program: str = "skinnet") -> None:
    """Print an error as a sentence."""
    note(describe(error), program)


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


def _escape(text: str, encoding: str | None) -> str:
    """Replace characters that an encoding does not have, and that control a terminal, by escapes.

    The name of a file may hold them, and change what a terminal shows and does.
    """
    encoding = encoding or "utf-8"
    text = _CONTROL.sub(lambda found: ascii(found[0])[1:-1], text)
    return text.encode(encoding, "backslashreplace").decode(encoding)
