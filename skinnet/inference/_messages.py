"""What the command prints: results to standard output, all else to standard error."""

import sys


def print_line(text: str) -> None:
    """Print a result."""
    print(_escape(text, sys.stdout.encoding), flush=True)


def note(sentence: str) -> None:
    """Print what the user should know."""
    print(_escape(f"skinnet: {sentence}", sys.stderr.encoding), file=sys.stderr, flush=True)


def report(error: Exception) -> None:
    """Print an error as a sentence."""
    note(describe(error))


def describe(error: Exception) -> str:
    """Describe an error in a sentence."""
    if isinstance(error, OSError):
        return f"{error.filename or 'A file'} cannot be used ({error.strerror}); check the path."
    return str(error)


def _escape(text: str, encoding: str | None) -> str:
    """Replace characters that an encoding does not have by escapes."""
    encoding = encoding or "utf-8"
    return text.encode(encoding, "backslashreplace").decode(encoding)
