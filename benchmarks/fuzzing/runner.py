"""Runs cases in a process of their own, which is ended if one takes too long or too much."""

import json
import os
import selectors
import subprocess
import sys
import time
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
from types import TracebackType
from typing import NamedTuple

MOST_SECONDS, MOST_GB = 5.0, 2.0
"""Processor time and memory of one case."""

WORKER = (sys.executable, "-m", "benchmarks.fuzzing.worker")
LONGEST_WAIT, KILL_GB = 90.0, 3.0
"""Seconds and memory after which the process is ended; a busy machine makes cases wait."""

_CASES = 3000
"""Cases of a process, after which a new one is started."""

_ROOT = Path(__file__).parents[2]


class Outcome(NamedTuple):
    """How a case has ended.

    Attributes:
        kind: Its class.
        seed: Its seed.
        end: "result", "sentence" or "fault".
        message: The sentence, or what the fault is.
        seconds: Processor time, of all threads.
        peak_gb: Largest memory of the process that ran it.
    """

    kind: str
    seed: int
    end: str
    message: str
    seconds: float
    peak_gb: float

    @property
    def survived(self) -> bool:
        """Whether it has ended with a result or a sentence, in time and memory."""
        return self.end != "fault"

    def describe(self) -> str:
        """Describe a fault, with the command that shows it again."""
        again = f"python -m benchmarks.faults --only {self.kind} --seed {self.seed} --cases 1"
        return f"{self.kind} {self.seed}: {self.message}\nAgain: {again}"


class Runner:
    """A process that runs cases; it is started at the first one, and again after a crash.

    Args:
        command: What is started: it reads and answers lines of JSON.
        longest_wait: Seconds after which a case that has not ended is a fault.
        kill_gb: Memory at which the process is ended.

    Example:
        >>> with Runner() as runner:
        ...     runner.run("landmarks", 0).survived
        True
    """

    def __init__(
        self,
        command: Sequence[str] = WORKER,
        longest_wait: float = LONGEST_WAIT,
        kill_gb: float = KILL_GB,
    ) -> None:
        self._command, self._longest_wait, self._kill_gb = command, longest_wait, kill_gb
        self._process: subprocess.Popen[str] | None = None
        self._count = 0

    def __enter__(self) -> "Runner":
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    def run(self, kind: str, seed: int) -> Outcome:
        """Run a case.

        Args:
            kind: Its class, of `benchmarks.fuzzing.CLASSES`.
            seed: Its seed.

        Returns:
            How it has ended.
        """
        ended = self._process is not None and self._process.poll() is not None
        if ended or self._count >= _CASES:
            self.close()
        process = self._process or self._start()
        assert process.stdin and process.stdout
        process.stdin.write(json.dumps([kind, seed]) + "\n")
        process.stdin.flush()
        self._count += 1
        started = time.monotonic()
        fault, peak = self._wait(process)
        line = "" if fault else process.stdout.readline()
        if not line:
            with suppress(subprocess.TimeoutExpired):
                process.wait(10)
            fault = fault or f"the process has crashed (exit code {process.poll()})"
            self.close()
            return Outcome(kind, seed, "fault", fault, time.monotonic() - started, peak)
        outcome = Outcome(kind, seed, **json.loads(line))
        return _check_limits(outcome)

    def close(self) -> None:
        """End the process."""
        process, self._process, self._count = self._process, None, 0
        if process is None:
            return
        with suppress(OSError):
            process.stdin.close()  # type: ignore[union-attr]
        try:
            process.wait(0.5)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()
        process.stdout.close()  # type: ignore[union-attr]

    def _start(self) -> "subprocess.Popen[str]":
        environment = {**os.environ, "OMP_NUM_THREADS": "1", "PYTHONPATH": str(_ROOT)}
        self._process = subprocess.Popen(
            list(self._command),
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            encoding="utf-8",
            env=environment,
        )
        return self._process

    def _wait(self, process: "subprocess.Popen[str]") -> tuple[str, float]:
        """Wait for an answer. Returns why the process was ended, if it was, and its memory."""
        started, memory = time.monotonic(), 0.0
        with selectors.DefaultSelector() as selector:
            selector.register(process.stdout, selectors.EVENT_READ)  # type: ignore[arg-type]
            while not selector.select(0.05):
                memory = max(memory, _read_memory(process.pid))
                if memory > self._kill_gb:
                    process.kill()
                    return f"it takes {memory:.1f} GB and more", memory
                if time.monotonic() - started > self._longest_wait:
                    process.kill()
                    return f"it has not ended after {self._longest_wait:g} s", memory
        return "", memory


def _check_limits(outcome: Outcome) -> Outcome:
    if outcome.end == "fault":
        return outcome
    if outcome.seconds > MOST_SECONDS:
        return outcome._replace(end="fault", message=f"it takes {outcome.seconds:.1f} s")
    if outcome.peak_gb > MOST_GB:
        return outcome._replace(end="fault", message=f"it takes {outcome.peak_gb:.1f} GB")
    return outcome


def _read_memory(process: int) -> float:
    """Memory of a process in GB; 0 where the system does not say."""
    try:
        pages = Path(f"/proc/{process}/statm").read_text(encoding="utf-8").split()[1]
    except (OSError, IndexError):
        return 0.0
    return int(pages) * os.sysconf("SC_PAGE_SIZE") / 1e9
