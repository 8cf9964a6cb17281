"""A photograph of a batch, and the key by which a later run knows it again."""

import hashlib
import json
from typing import NamedTuple

_DIGITS = 32

NO_ROW = -1
"""Row of a photograph that is a file of its own."""

UNKNOWN = -1
"""Size of a file that is not there, or whose store does not say."""


class Photograph(NamedTuple):
    """A photograph to read.

    Attributes:
        file: Its name for people: the path as it was given, or the URL.
        source: Full path or URL of its file.
        row: Its row, if that is a Parquet file; else `NO_ROW`.
        size: Size of that file in bytes.
        modified: When that file was last written, in nanoseconds since 1970; 0 if not known.
        fault: Why it cannot be read, if that is known already; else empty.
    """

    file: str
    source: str
    row: int = NO_ROW
    size: int = UNKNOWN
    modified: int = 0
    fault: str = ""

    @property
    def key(self) -> str:
        """Names this state of the photograph: path, row, size and time of the last change."""
        state = json.dumps([self.source, self.row, self.size, self.modified])
        return hashlib.sha256(state.encode()).hexdigest()[:_DIGITS]
