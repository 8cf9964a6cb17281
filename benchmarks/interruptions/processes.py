"""Commands in processes of their own, which a fault may strike."""

import os
import sys
import time
from collections.abc import Callable, Sequence
from importlib import import_module
from multiprocessing import get_context
from multiprocessing.connection import Connection
from pathlib import Path
from typing import NamedTuple

from benchmarks.interruptions.faults import Fault, prepare

Command = tuple[str, ...]
"""The module of a command line, `skinnet.cli` or `train.cli`, and its arguments."""

_MODULES = ["skinnet.cli", "skinnet.inference._photo_verbs", "skinnet.pipeline._maps", "train.cli"]

_SECONDS = 300.0


class Outcome(NamedTuple):
    """What became of commands.

    Attributes:
        code: Exit code of the last command that ran; negative for a signal.
        said: What was printed to standard error.
        writes: Number of writes into the folder; 0 after a kill.
        seconds: How long it took.
    """

    code: int
    said: str
    writes: int
    seconds: float


class Runner:
    """Runs commands in processes that are forked from one that has imported the libraries.

    Args:
        log: File for what they print.
        folder: The folder that they write into.
        mounted: Whether it is a small file system.
    """

    def __init__(self, log: Path, folder: Path, mounted: bool) -> None:
        self.log, self.folder, self.mounted = log, folder, mounted
        self._context = get_context("forkserver")
        self._context.set_forkserver_preload(_MODULES)

    def run(self, commands: Sequence[Command], fault: Fault | None = None) -> Outcome:
        """Run commands one after the other, up to the first that fails.

        Args:
            commands: The commands.
            fault: What strikes their process; None for nothing.
        """
        ours, theirs = self._context.Pipe(duplex=False)
        arguments = (commands, fault, self.folder, self.mounted, self.log, theirs)
        process = self._context.Process(target=_work, args=arguments)
        process.start()
        theirs.close()
        ours.recv()  # the process is ready
        start = time.perf_counter()
        process.join(_SECONDS if fault is None or fault.seconds is None else fault.seconds)
        if process.is_alive():
            process.kill()
            process.join()
        seconds = time.perf_counter() - start
        writes = _receive(ours)
        said = self.log.read_text(encoding="utf-8", errors="replace")
        return Outcome(process.exitcode or 0, said, writes, seconds)


def _receive(connection: Connection) -> int:
    try:
        return int(connection.recv())
    except (EOFError, OSError):  # the process was killed
        return 0
    finally:
        connection.close()


def _work(
    commands: Sequence[Command],
    fault: Fault | None,
    folder: Path,
    mounted: bool,
    log: Path,
    connection: Connection,
) -> None:
    with log.open("wb") as file:
        os.dup2(file.fileno(), 2)
    os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
    os.chdir(folder.parent)
    count = prepare(fault, folder, mounted)
    connection.send("ready")
    code = 0
    for module, *arguments in commands:
        main: Callable[[Sequence[str]], int] = import_module(module).main
        code = main(arguments)
        if code:
            break
    connection.send(count())
    sys.exit(code)
