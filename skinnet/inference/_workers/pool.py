"""Worker processes that do the photographs of a run, whose outcomes come in order."""

import os
import pickle
import re
import threading
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from functools import lru_cache, partial
from pathlib import Path
from typing import Any, Protocol

from skinnet.errors import InputError
from skinnet.images._result_names import _fold
from skinnet.images._walk import Found
from skinnet.inference._messages import get_verbosity
from skinnet.inference._workers.outcome import Outcome
from skinnet.inference._workers.schedule import Schedule
from skinnet.inference._workers.worker_process import WorkerDiedError, WorkerProcess

WAITING = 4
"""Photographs a worker that may be finished before an earlier one is; their numbers wait."""

_NUMBERED = re.compile(r"(?:(?:-|_face)[1-9]\d*)+$")
"""What names of results may have after that of the photograph."""


class Work(Protocol):
    """What a worker does with photographs; it can be pickled."""

    def load(self) -> None:
        """Open what all photographs need."""

    def __call__(self, picture: Found) -> object:
        """Do a photograph."""


@contextmanager
def open_pool(
    work: Callable[[Found], Any], pictures: Sequence[Found], workers: int, one_folder: bool
) -> Iterator[Callable[[int], Outcome]]:
    """Start worker processes on photographs.

    Args:
        work: What to do with each, a `Work`.
        pictures: The photographs.
        workers: Number of processes.
        one_folder: Whether all results are in one folder.

    Yields:
        A function that waits for what became of a photograph, by its place; each is asked for once,
        in order. It raises `InputError` if the processes do not start.
    """
    pool = _Pool(work, pictures, workers, one_folder)
    try:
        pool.start()
        yield pool.schedule.get
    except BaseException:
        pool.terminate()
        raise
    finally:
        pool.close()


class _Pool:
    def __init__(
        self,
        work: Callable[[Found], Any],
        pictures: Sequence[Found],
        workers: int,
        one_folder: bool,
    ) -> None:
        keys = (_find_key(picture, one_folder) for picture in pictures)
        self.schedule = Schedule(keys, WAITING * workers)
        self._pictures = pictures
        self._work = pickle.dumps((get_verbosity(), work))
        self._processes: set[WorkerProcess] = set()
        self._lock = threading.Lock()
        self._threads = [threading.Thread(target=self._attend) for _ in range(workers)]
        self._attended = workers

    def start(self) -> None:
        """Start the workers."""
        for thread in self._threads:
            thread.start()

    def terminate(self) -> None:
        """End all workers now."""
        self.schedule.stop()
        with self._lock:
            for process in self._processes:
                process.terminate()

    def close(self) -> None:
        """Wait until all workers have ended."""
        self.schedule.stop()
        for thread in self._threads:
            if thread.ident is not None:
                thread.join()

    def _attend(self) -> None:
        """Keep a worker process busy; one that dies is replaced."""
        try:
            while not self.schedule.stopped:
                with self._start() as process:
                    if self._feed(process):
                        return
        except (InputError, OSError) as fault:
            self._give_up(fault)
        except BaseException as fault:
            self.schedule.fail(fault)

    def _give_up(self, fault: Exception) -> None:
        """Go on with the other workers; without any the run ends."""
        with self._lock:
            self._attended -= 1
            if self._attended == 0:
                self.schedule.fail(fault)

    @contextmanager
    def _start(self) -> Iterator[WorkerProcess]:
        process = WorkerProcess(self._work)
        with self._lock:
            self._processes.add(process)
            if self.schedule.stopped:
                process.terminate()
        try:
            yield process
        finally:
            process.close()
            with self._lock:
                self._processes.remove(process)

    def _feed(self, process: WorkerProcess) -> bool:
        """Give photographs to a worker. Returns whether there is none left; else it has died."""
        try:
            process.open()
        except WorkerDiedError as error:
            raise InputError(
                f"A process that reads photographs does not start: {error}. Give --workers 1."
            ) from error
        while (place := self.schedule.take()) is not None:
            try:
                outcome = process.do(self._pictures[place], partial(self.schedule.wait_turn, place))
            except WorkerDiedError as error:
                fault = _describe_death(self._pictures[place], error)
                self.schedule.finish(place, Outcome(error=fault))
                return False
            self.schedule.finish(place, outcome)
        return True


def _describe_death(picture: Found, error: WorkerDiedError) -> InputError:
    return InputError(
        f"{picture.path} is not done, since the process that had it has ended: {error}. Do it "
        "again with --workers 1; if that fails too, make the photograph smaller."
    )


def _find_key(picture: Found, one_folder: bool) -> tuple[str, str]:
    """What photographs have in common whose results may want the same names."""
    path = Path(picture.path)
    folder = "" if one_folder else _find_folder(str(path.parent))
    return folder, _NUMBERED.sub("", _fold(path.stem))


@lru_cache(1024)
def _find_folder(folder: str) -> str:
    return os.path.realpath(folder)
