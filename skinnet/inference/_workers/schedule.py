"""Which photograph is next, and whose turn it is, for threads that each have a worker process."""

import threading
from collections.abc import Hashable, Iterable

from skinnet.inference._workers.outcome import Outcome

_POLL = 0.5
"""Seconds after which a wait looks again; Windows cannot interrupt one by Ctrl-C."""


class Schedule:
    """Hands out places in the list of photographs, in order, and takes what became of each.

    Args:
        keys: For each photograph what it shares with those that may want the same names.
        window: How many photographs at most are in work or wait to be read by `get`.
    """

    def __init__(self, keys: Iterable[Hashable], window: int) -> None:
        self._before = _link(keys)
        self._window = window
        self._next = self._given = 0
        self._finished = bytearray(len(self._before))
        self._outcomes: dict[int, Outcome] = {}
        self._fault: BaseException | None = None
        self._changed = threading.Condition()
        self.stopped = False

    def take(self) -> int | None:
        """Take the place of the next photograph; None if there is none."""
        with self._changed:
            self._changed.wait_for(lambda: self._is_over() or self._is_open())
            if self._is_over():
                return None
            self._next += 1
            return self._next - 1

    def wait_turn(self, place: int) -> None:
        """Wait until the last photograph before this one that has its key is finished."""
        before = self._before[place]
        with self._changed:
            self._changed.wait_for(lambda: self.stopped or before < 0 or self._finished[before])

    def finish(self, place: int, outcome: Outcome) -> None:
        """Hand in what became of a photograph."""
        with self._changed:
            self._outcomes[place] = outcome
            self._finished[place] = True
            self._changed.notify_all()

    def fail(self, fault: BaseException) -> None:
        """Hand in an error that ends the run."""
        with self._changed:
            self._fault = self._fault or fault
            self.stopped = True
            self._changed.notify_all()

    def stop(self) -> None:
        """Hand out no more."""
        with self._changed:
            self.stopped = True
            self._changed.notify_all()

    def get(self, place: int) -> Outcome:
        """Wait for what became of a photograph; each is asked for once, in order."""
        with self._changed:
            while place not in self._outcomes and self._fault is None:
                self._changed.wait(_POLL)
            if self._fault is not None and place not in self._outcomes:
                raise self._fault
            self._given = place + 1
            self._changed.notify_all()
            return self._outcomes.pop(place)

    def _is_over(self) -> bool:
        return self.stopped or self._next == len(self._before)

    def _is_open(self) -> bool:
        return self._next < self._given + self._window


def _link(keys: Iterable[Hashable]) -> list[int]:
    """For each photograph the place of the last one before it that has its key; -1 for none."""
    latest: dict[Hashable, int] = {}
    before = []
    for place, key in enumerate(keys):
        before.append(latest.get(key, -1))
        latest[key] = place
    return before
