"""Libraries that read pictures print nothing: what is wrong is raised, and said in one sentence."""

import ctypes
import logging
import os
import threading
from contextlib import suppress
from functools import cache
from tempfile import TemporaryFile

from PIL import _imaging

_LOGGERS = ("PIL", "tifffile")
_LIBRAW = (b"unknown file: ",)
"""How lines begin that LibRaw prints of data in memory."""


@cache
def silence_libraries() -> None:
    """Keep Pillow, tifffile and libtiff from printing; an application's own log gets it still."""
    for name in _LOGGERS:
        # Without a handler Python prints warnings of libraries.
        logging.getLogger(name).addHandler(logging.NullHandler())
    with suppress(OSError, AttributeError):  # Pillow's library may not show its parts
        ctypes.CDLL(_imaging.__file__).TIFFSetErrorHandler(None)


class _Filter:
    """Standard error while LibRaw runs, in as many threads as there are."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._count = 0

    def __enter__(self) -> None:
        with self._lock:
            self._count += 1
            if self._count == 1:
                self._printed, self._kept = TemporaryFile(), os.dup(2)
                os.dup2(self._printed.fileno(), 2)

    def __exit__(self, *_: object) -> None:
        with self._lock:
            self._count -= 1
            if self._count == 0:
                os.dup2(self._kept, 2)
                self._replay()
                os.close(self._kept)
                self._printed.close()

    def _replay(self) -> None:
        """Print what is not of LibRaw, such as what other threads have said."""
        self._printed.seek(0)
        others = b"".join(line for line in self._printed if not line.startswith(_LIBRAW))
        with suppress(OSError):
            os.write(2, others)


silence_libraw = _Filter()
"""Leaves out what LibRaw prints to standard error; all else is printed at the end."""
