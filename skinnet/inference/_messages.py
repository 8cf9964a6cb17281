"""What the command prints: results to standard output, all else to standard error."""

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from enum import IntEnum


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


def print_line(text: str) -> None:
    """Print a result: what was asked for."""
    print(_escape(text, sys.stdout.encoding), flush=True)


def note(sentence: str) -> None:
    """Print what the user should know, unless --quiet is given."""
    if _level >= Verbosity.USUAL:
        _print_error(f"skinnet: {sentence}")


def explain(sentence: str) -> None:
    """Print what was assumed, how long something took, and the like, if --verbose is given."""
    if _level >= Verbosity.VERBOSE:
        _print_error(f"skinnet: {sentence}")


def log(line: str) -> None:
    """Print a line on the progress of long work, unless --quiet is given."""
    if _level >= Verbosity.USUAL:
        _print_error(line)


def report(error: Exception) -> None:
    """Print an error as a sentence, always."""
    _print_error(f"skinnet: {describe(error)}")


def describe(error: Exception) -> str:
    """Describe an error in a sentence."""
    if isinstance(error, OSError):
        return f"{error.filename or 'A file'} cannot be used ({error.strerror}); check the path."
    return str(error)


def _print_error(line: str) -> None:
    print(_escape(line, sys.stderr.encoding), file=sys.stderr, flush=True)


def _escape(text: str, encoding: str | None) -> str:
    """Replace characters that an encoding does not have by escapes."""
    encoding = encoding or "utf-8"
    return text.encode(encoding, "backslashreplace").decode(encoding)
