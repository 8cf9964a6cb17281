"""How many worker processes a run has."""

import os
import sys
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path

from skinnet.errors import InputError
from skinnet.images._walk import STDIN, Found
from skinnet.inference._providers import CPU, choose_providers

MOST = 256
"""The largest number that may be asked for."""

_EACH = 3
"""Photographs that a worker has at least: it starts in the time of about two."""

_MEMORY = 1 << 30
"""Bytes for each worker: what one of 12 megapixels takes, and something more."""

_LIMITS = ("/sys/fs/cgroup/memory.max", "/sys/fs/cgroup/memory/memory.limit_in_bytes")
"""Files in which Linux states the memory of a container."""


def choose_count(
    asked: int | None, pictures: Sequence[Found], provider: str | Sequence[str] | None = None
) -> int:
    """Choose a number of workers; 1 is this process alone.

    Args:
        asked: What the user asks for; None for what suits the cores, the memory and the number of
            photographs.
        pictures: The photographs.
        provider: What runs the networks.

    Raises:
        InputError: It is not a number from 1 to 256, or the provider is not known.
    """
    if asked is not None and not 1 <= asked <= MOST:
        raise InputError(
            f"--workers is a number of processes from 1 to {MOST}; got {asked}. This computer has "
            f"{count_cores()} cores."
        )
    count = sum(picture.error is None for picture in pictures)
    if any(picture.path == STDIN for picture in pictures) or not _can_start():
        return 1  # standard input is read here
    if asked is not None:
        return max(1, min(asked, count))
    if [CPU] != choose_providers(provider).installed[:1]:
        return 1  # a device is one, however many processes wait for it
    return max(1, min(count_cores(), count // _EACH, measure_memory() // _MEMORY, MOST))


def count_cores() -> int:
    """Count the cores that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def measure_memory() -> int:
    """Measure the memory, in bytes, of the computer or the container; huge where it is unknown."""
    sizes = [1 << 50]
    with suppress(OSError, ValueError, AttributeError):  # AttributeError: Windows
        sizes.append(os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE"))
    for file in _LIMITS:
        with suppress(OSError, ValueError):  # no such limit, or "max"
            sizes.append(int(Path(file).read_text(encoding="ascii")))
    return min(size for size in sizes if size > 0)


def _can_start() -> bool:
    """Whether there is an interpreter to start; a frozen program has none."""
    return bool(sys.executable) and not getattr(sys, "frozen", False)
