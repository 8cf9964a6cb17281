"""The turns in which photographs choose the names of their results."""

from collections.abc import Callable

_wait: Callable[[], None] | None = None


def wait_turn() -> None:
    """Wait until all earlier photographs of the run that may want the same names have theirs.

    In a run of one process they always have.
    """
    if _wait is not None:
        _wait()


def set_turns(wait: Callable[[], None] | None) -> None:
    """Set how this process waits for its turn; None for not at all."""
    global _wait
    _wait = wait
