"""A worker process: reads what to do from standard input, and writes what became of it.

It ends when it is told to, and when the process that has started it is gone; either way nothing
that is half written stays.
"""

import os
import pickle
import signal
import sys
import threading
from queue import SimpleQueue
from types import FrameType
from typing import IO, Any

from skinnet.inference._messages import set_verbosity
from skinnet.inference._workers.outcome import record
from skinnet.inference._workers.turns import set_turns
from skinnet.inference._workers.worker_process import END, READY, TURN


def serve(source: IO[bytes], target: IO[bytes]) -> None:
    """Do photographs until the end.

    Args:
        source: Gives the level of messages and the work, then photographs, all pickled.
        target: Takes an outcome for each photograph.
    """
    level, work = pickle.load(source)
    set_verbosity(level)
    messages: SimpleQueue[Any] = SimpleQueue()
    threading.Thread(target=_receive, args=(source, messages), daemon=True).start()

    def wait_turn() -> None:
        _send(target, TURN)
        messages.get()

    set_turns(wait_turn)
    work.load()
    _send(target, READY)
    while (message := messages.get()) != END:
        _send(target, record(work, message))


def _receive(source: IO[bytes], messages: "SimpleQueue[Any]") -> None:
    """Take messages in; without a process that sends them this one ends itself."""
    message = None
    while message != END:
        try:
            message = pickle.load(source)
        except (EOFError, OSError, pickle.UnpicklingError):
            os.kill(os.getpid(), signal.SIGTERM)
            return
        messages.put(message)


def _send(target: IO[bytes], message: object) -> None:
    pickle.dump(message, target)
    target.flush()


def _take_streams() -> tuple[IO[bytes], IO[bytes]]:
    """Take standard input and output for messages; what a library prints goes to the errors."""
    source, target = (os.fdopen(os.dup(number), mode) for number, mode in ((0, "rb"), (1, "wb")))
    null = os.open(os.devnull, os.O_RDONLY)
    os.dup2(null, 0)
    os.close(null)
    os.dup2(2, 1)
    return source, target


def _quit(number: int, frame: FrameType | None) -> None:
    """End by an exception, so that what is half written is removed, and once alone."""
    signal.signal(signal.SIGTERM, signal.SIG_IGN)
    sys.exit(0)


def main() -> None:
    """Run the worker."""
    signal.signal(signal.SIGTERM, _quit)
    code = 1
    try:
        serve(*_take_streams())
        code = 0
    except BrokenPipeError:
        pass  # the process that has started this one is gone
    except Exception:
        sys.excepthook(*sys.exc_info())
    finally:
        # The thread that waits for messages holds their stream, which Python would flush.
        os._exit(code)


if __name__ == "__main__":
    main()
