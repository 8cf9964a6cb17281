"""Lines of OBJ and MTL files: line ends, indentation, continuations, comments, and numbers."""

import re
import warnings
from pathlib import Path
from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float, Int, UInt8

from skinnet.errors import InputError
from skinnet.files import READ_ERRORS
from skinnet.files._reading import read_file

_SPACE, _SLASH = 32, ord("/")
_ENCODINGS = {b"\xff\xfe": "utf-16", b"\xfe\xff": "utf-16", b"\xef\xbb\xbf": "utf-8-sig"}
# A comment may end with a back-slash, and does not continue.
_CONTINUED = re.compile(rb"(?m)^(?:[^\n#]*\\[ \t]*\n)+[^\n]*")
_INDENTED = re.compile(rb"(?m)^[ \t\v\f]+")
_INDENTS = (b"\n ", b"\n\t", b"\n\v", b"\n\f")
_COMMENT = re.compile(rb"#[^\n]*")
# How Microsoft's C library writes numbers that are not finite.
_NOT_FINITE = re.compile(rb"[+-]?1\.#[A-Za-z]+\d*")
_NUMBER = re.compile(rb"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?|[+-]?(nan|inf|infinity)", re.I)


class Lines(NamedTuple):
    """A text file as bytes, and where each line starts and ends (at its line feed)."""

    path: Path
    text: UInt8[np.ndarray, "bytes"]
    starts: Int[np.ndarray, "lines"]
    ends: Int[np.ndarray, "lines"]

    def take(self, line: int) -> bytes:
        """Take one line, without its line feed."""
        return self.text[self.starts[line] : self.ends[line]].tobytes()

    def fault(self, line: int, what: str) -> InputError:
        """Make the error of a line that is counted from 0."""
        return InputError(
            f"{self.path} cannot be read as a mesh: line {line + 1} {what}; export it again."
        )


class Numbers(NamedTuple):
    """The numbers of some lines in one row, and where those of each line start."""

    values: Float[np.ndarray, "numbers"]
    counts: Int[np.ndarray, "lines"]
    starts: Int[np.ndarray, "lines"]


def read_lines(path: Path) -> Lines:
    """Read the lines of a text file in UTF-8, UTF-16, or any encoding that contains ASCII.

    Lines end with LF, CR LF or CR and lose their indentation. A line that is continued takes the
    next ones in, which are left empty, so that lines keep their numbers.

    Raises:
        InputError: If the file cannot be read, or is no text.
    """
    try:
        content = read_file(path)
        for mark, encoding in _ENCODINGS.items():
            if content.startswith(mark):
                content = content.decode(encoding).encode()
    except InputError:
        raise
    except READ_ERRORS as error:
        raise InputError(f"{path} cannot be read ({error}); copy it again.") from error
    if b"\0" in content:
        raise InputError(
            f"{path} cannot be read as a mesh: it is not a text file, as OBJ and MTL are; export "
            "it again."
        )
    content = content.replace(b"\r\n", b"\n").replace(b"\r", b"\n")
    if b"\\" in content:
        content = _CONTINUED.sub(_join, content)
    if content[:1].isspace() or any(mark in content for mark in _INDENTS):
        content = _INDENTED.sub(b"", content)
    text = np.frombuffer(content + b"\n", np.uint8)
    ends = np.flatnonzero(text == ord("\n"))
    return Lines(path, text, np.append(0, ends[:-1] + 1), ends)


def cut_keyword(lines: Lines, chosen: Bool[np.ndarray, "lines"], length: int) -> bytes:
    """Cut keywords of a length, and comments, from the chosen lines."""
    sizes = lines.ends - lines.starts + 1
    text = lines.text[np.repeat(chosen, sizes)]
    first = np.cumsum(sizes[chosen]) - sizes[chosen]
    for letter in range(length):
        text[first + letter] = _SPACE
    content: bytes = text.tobytes()
    if b"#" in content:
        content = _COMMENT.sub(b"", _NOT_FINITE.sub(b"nan", content))
    return content


def parse_numbers(lines: Lines, chosen: Bool[np.ndarray, "lines"], length: int) -> Numbers:
    """Parse the numbers after keywords of a length in the chosen lines."""
    content = cut_keyword(lines, chosen, length)
    starting = mark_words(np.frombuffer(content, np.uint8))
    counts = count_by_line(content, starting)
    values = convert(content, np.float64)
    if len(values) != counts.sum():
        raise _find_fault(lines, chosen, content)
    return Numbers(values, counts, np.cumsum(counts) - counts)


def convert(content: bytes, kind: type) -> np.ndarray:
    """Convert words to numbers; none, or those before it, if a word is no number."""
    if content.isspace():
        return np.zeros(0, kind)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)  # what an older NumPy gives
        try:
            return np.fromstring(content.decode("latin-1"), dtype=kind, sep=" ")
        except ValueError:
            return np.zeros(0, kind)


def mark_words(text: UInt8[np.ndarray, "bytes"]) -> Bool[np.ndarray, "bytes"]:
    """Mark the first byte of each word."""
    filled = text > _SPACE
    return np.asarray(filled & ~np.append(False, filled[:-1])[: len(filled)])


def count_by_line(content: bytes, marked: Bool[np.ndarray, "bytes"]) -> Int[np.ndarray, "lines"]:
    """Count the marked bytes of each line."""
    ends = np.flatnonzero(np.frombuffer(content, np.uint8) == ord("\n"))
    until = np.append(0, np.cumsum(marked, dtype=np.int64))[ends]
    return np.asarray(np.diff(until, prepend=0))


def _join(found: re.Match[bytes]) -> bytes:
    joined, count = re.subn(rb"\\[ \t]*\n", b" ", found[0])
    return joined + b"\n" * count


def _find_fault(lines: Lines, chosen: Bool[np.ndarray, "lines"], content: bytes) -> InputError:
    rows = zip(np.flatnonzero(chosen).tolist(), content.split(b"\n"), strict=False)
    pairs = ((line, word) for line, rest in rows for word in rest.split())
    line, wrong = next(pair for pair in pairs if not _NUMBER.fullmatch(pair[1]))
    word = wrong.decode("utf-8", "replace")
    comma = ", with a comma for the decimal point" if re.fullmatch(r"-?\d+,\d+", word) else ""
    return lines.fault(line, f"has {word[:40]!r}{comma}, where a number belongs")
