"""A worker process, as the process of the command sees it."""

import os
import pickle
import signal
import subprocess
import sys
from collections.abc import Callable
from typing import IO, Any, cast

from skinnet.images._walk import Found
from skinnet.inference._workers.outcome import Outcome

READY, TURN, END = "ready", "turn", "end"
"""Messages: the worker has opened its networks; it waits for, or has, its turn; it is to end."""

_PATIENCE = 10.0
"""Seconds in which a worker that is asked to end removes its partial files."""


class WorkerDiedError(Exception):
    """A worker process has ended by itself; the message says how."""


class WorkerProcess:
    """A new process of Python that does photographs one after another.

    It is a fresh interpreter, so that nothing of the caller's program runs a second time. It has a
    process group of its own: Ctrl-C reaches the command alone, which then ends its workers.

    Args:
        work: What it does with each photograph, pickled.

    Raises:
        OSError: The system does not start it.
    """

    def __init__(self, work: bytes) -> None:
        self._process = subprocess.Popen(
            _make_command(),
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            env=_make_environment(),
            **_make_group(),
        )
        self._work = work

    def open(self) -> None:
        """Hand over the work, and wait until the worker can begin.

        Raises:
            WorkerDiedError: It has ended.
        """
        self._send(self._work)
        self._receive()

    def do(self, picture: Found, wait_turn: Callable[[], None]) -> Outcome:
        """Do a photograph.

        Raises:
            WorkerDiedError: The process has ended.
        """
        self._send(pickle.dumps(picture))
        while (answer := self._receive()) == TURN:
            wait_turn()
            self._send(pickle.dumps(TURN))
        return cast(Outcome, answer)

    def terminate(self) -> None:
        """Ask the worker to end now; it removes what it has half written."""
        self._process.terminate()

    def close(self) -> None:
        """End the worker, and wait until it has ended."""
        try:
            self._send(pickle.dumps(END))
        except WorkerDiedError:
            pass
        try:
            self._process.wait(_PATIENCE)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()
        for stream in (self._input, self._output):
            try:
                stream.close()
            except OSError:  # what it has not read
                pass

    @property
    def _input(self) -> IO[bytes]:
        return cast(IO[bytes], self._process.stdin)

    @property
    def _output(self) -> IO[bytes]:
        return cast(IO[bytes], self._process.stdout)

    def _send(self, data: bytes) -> None:
        try:
            self._input.write(data)
            self._input.flush()
        except (OSError, ValueError) as error:
            raise WorkerDiedError(self._describe_end()) from error

    def _receive(self) -> Any:
        try:
            return pickle.load(self._output)
        except (EOFError, OSError, ValueError, pickle.UnpicklingError) as error:
            raise WorkerDiedError(self._describe_end()) from error

    def _describe_end(self) -> str:
        try:
            code = self._process.wait(_PATIENCE)
        except subprocess.TimeoutExpired:
            return "it does not answer"
        if code >= 0:
            return f"it ended with code {code}"
        if -code == getattr(signal, "SIGKILL", None):
            return "it was killed, as the system does where memory runs out"
        return f"it ended by signal {-code}"


def _make_command() -> list[str]:
    utf8 = ["-X", "utf8"] if sys.flags.utf8_mode else []
    return [sys.executable, "-P", *utf8, "-m", "skinnet.inference._workers"]


def _make_environment() -> dict[str, str]:
    """The environment, in which modules are found where this process finds them."""
    path = os.pathsep.join(each or os.getcwd() for each in sys.path)
    return {**os.environ, "PYTHONPATH": path}


def _make_group() -> dict[str, Any]:
    if sys.platform == "win32":
        return {"creationflags": subprocess.CREATE_NEW_PROCESS_GROUP}
    return {"process_group": 0}
