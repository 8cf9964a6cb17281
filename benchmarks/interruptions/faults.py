"""Faults that strike a process: at a moment, at a write, or at a number of bytes."""

import errno
import os
import resource
import signal
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

KILL, READ_ONLY, FULL = "kill", "read-only", "full"


class Fault(NamedTuple):
    """What strikes a process.

    Attributes:
        kind: `KILL`, `READ_ONLY` or `FULL`.
        write: Before which write (0 is the first) it strikes; None for not at a write.
        seconds: After which time a kill strikes; None for not by time.
        size: For `FULL`, the bytes that the disk has left; without a small file system to mount,
            those that any one file may have.
    """

    kind: str
    write: int | None = None
    seconds: float | None = None
    size: int | None = None


_WRITES = {"os.rename": 1, "os.link": 1, "os.mkdir": 0, "os.remove": 0, "os.truncate": 0}
"""Events of Python's audit that change a folder, and which argument names the changed path."""


def watch_writes(folder: Path, strike: Callable[[int, str], None]) -> None:
    """Call a function before each write of this process into a folder, for ever.

    Args:
        folder: The folder.
        strike: Takes the number of the write, and its path.
    """
    root, count = os.path.realpath(folder), 0

    def hook(event: str, arguments: tuple[Any, ...]) -> None:
        nonlocal count
        path = _find_target(event, arguments)
        if path is not None and os.path.abspath(path).startswith(root):
            count += 1
            strike(count - 1, path)

    sys.addaudithook(hook)


def _find_target(event: str, arguments: tuple[Any, ...]) -> str | None:
    """The path that an event is about to change; None if it changes none."""
    if event == "open":
        path, _, flags = arguments
        writes = flags & (os.O_WRONLY | os.O_RDWR | os.O_CREAT)
        return os.fsdecode(path) if writes and isinstance(path, str | bytes | os.PathLike) else None
    if event in _WRITES:
        return os.fsdecode(arguments[_WRITES[event]])
    return None


def prepare(fault: Fault | None, folder: Path, mounted: bool) -> Callable[[], int]:
    """Have a fault strike this process.

    Args:
        fault: The fault; None for none.
        folder: The folder that the process writes into.
        mounted: Whether a small file system does what a full disk does.

    Returns:
        How many writes there were so far.
    """
    count = 0

    def strike(number: int, path: str) -> None:
        nonlocal count
        count = number + 1
        if fault is None or fault.write is None or number < fault.write:
            return
        if fault.kind == KILL:
            os.kill(os.getpid(), signal.SIGKILL)
        if fault.kind == READ_ONLY:
            raise OSError(errno.EROFS, os.strerror(errno.EROFS), path)

    watch_writes(folder, strike)
    if fault is not None and fault.kind == FULL and not mounted:
        resource.setrlimit(resource.RLIMIT_FSIZE, (fault.size or 0, resource.RLIM_INFINITY))
    return lambda: count
