"""Measures the time of an action and the memory of this process."""

import time
from collections.abc import Callable
from pathlib import Path


def time_least(action: Callable[[], object], repeats: int) -> float:
    """Measure the least time of several runs of an action, in seconds."""
    times = []
    for _ in range(repeats):
        start = time.perf_counter()
        action()
        times.append(time.perf_counter() - start)
    return min(times)


def read_resident_kb(name: str) -> int:
    """Read the resident memory of this process now (VmRSS) or at its peak (VmHWM); Linux only."""
    lines = Path("/proc/self/status").read_text(encoding="utf-8").splitlines()
    return next(int(line.split()[1]) for line in lines if line.startswith(name))
