"""A run of a verb over its inputs: what fails is named, the rest goes on, all are counted."""

import time
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import partial
from typing import Any

from skinnet.errors import InputError, NoFaceError
from skinnet.images._walk import STDIN, Found, Walk
from skinnet.inference._progress import show_progress
from skinnet.inference._workers.pool import open_pool

_FACELESS, _UNWRITTEN, _UNREADABLE = "without a face", "could not be written", "could not be read"
"""Why an input failed, as the sentence at the end of a run says it."""


class NotWrittenError(InputError):
    """The results of an input that was read could not be written."""


@dataclass
class Totals:
    """What has become of the inputs of a run.

    Attributes:
        photographs: Number of inputs that were done.
        faces: Number of faces in them; 0 if none were looked for.
        failures: Number of inputs that failed, by reason.
        seconds: How long the run took.
    """

    photographs: int = 0
    faces: int = 0
    failures: Counter[str] = field(default_factory=Counter)
    seconds: float = 0.0


def run_over(
    found: Walk,
    work: Callable[[Found], Any],
    fail: Callable[[str, Exception], None],
    quiet: bool = False,
    *,
    take: Callable[[Any], int] = int,
    workers: int = 1,
    one_folder: bool = False,
) -> Totals:
    """Do the work on every input, with a bar on a terminal.

    What is printed, taken and counted comes in the order of the inputs, whatever the number of
    workers.

    Args:
        found: The inputs.
        work: What to do with one; it raises `InputError` or `OSError` if the input cannot be used.
            For several workers it is a `Work`.
        fail: Called with the name of an input that failed and with the error, to print it.
        quiet: Whether to show no progress.
        take: Takes what the work returned, and returns the number of faces; by default it is that
            number. It raises what the work may raise.
        workers: Number of processes that do the work; 1 is this one.
        one_folder: Whether all results are in one folder, and not beside their inputs.

    Returns:
        What has become of the inputs.
    """
    totals, start = Totals(), time.monotonic()
    with (
        show_progress(len(found.pictures), quiet) as advance,
        _open_work(found, work, workers, one_folder) as get,
    ):
        for picture in found.pictures:
            _do_one(picture, get(picture), take, fail, totals)
            advance(totals.failures.total())
    totals.seconds = time.monotonic() - start
    return totals


@contextmanager
def _open_work(
    found: Walk, work: Callable[[Found], Any], workers: int, one_folder: bool
) -> Iterator[Callable[[Found], Callable[[], Any]]]:
    """Yield a function from an input to one that does it, or that gives what a worker made of it.

    Errors of the workers themselves are raised by the first one, and end the run.
    """
    if workers == 1:
        yield lambda picture: partial(work, picture)
        return
    pictures = [picture for picture in found.pictures if picture.error is None]
    places = iter(range(len(pictures)))
    with open_pool(work, pictures, workers, one_folder) as wait:
        yield lambda picture: wait(next(places)).replay if picture.error is None else int


def _do_one(
    picture: Found,
    work: Callable[[], Any],
    take: Callable[[Any], int],
    fail: Callable[[str, Exception], None],
    totals: Totals,
) -> None:
    try:
        if picture.error is not None:
            raise picture.error
        totals.faces += take(work())
        totals.photographs += 1
    except BrokenPipeError:
        raise
    except (InputError, OSError) as error:
        totals.failures[_name_reason(error)] += 1
        fail(name_input(picture), error)


def name_input(found: Found) -> str:
    """The name of an input in messages."""
    return "standard input" if found.path == STDIN else found.path


def is_one_file(found: Walk, inputs: list[str]) -> bool:
    """Whether the user has named one file alone, so that a run needs no sentence at its end."""
    single = len(found.pictures) == 1 and found.pictures[0].path == inputs[0]
    return single and not found.passed_over and len(inputs) == 1


def describe_totals(totals: Totals, found: Walk, done: str = "read", where: str = "") -> str:
    """Say how many inputs were done and not done, how fast, and where the results are.

    Args:
        totals: What `run_over` returned.
        found: The inputs.
        done: What was done with them: `read` or `edited`.
        where: What was written and where, such as `maps in skinmaps`; "" for nothing.
    """
    parts = [_describe_done(totals, done), _describe_failures(totals, done)]
    if found.passed_over:
        parts.append(f"{len(found.passed_over)} passed over")
    if totals.photographs and totals.seconds > 0:
        count = totals.photographs + totals.failures.total()
        parts.append(f"{count / totals.seconds:.2g} per second")
    reasons = found.describe_passed_over()
    return (
        ", ".join(parts)
        + (f": {where}" if where and totals.photographs else "")
        + (f". Passed over: {reasons}." if reasons else ".")
    )


def _describe_done(totals: Totals, done: str) -> str:
    photographs = f"{totals.photographs} photograph{'s' * (totals.photographs != 1)}"
    if not totals.faces:
        return f"{photographs} {done}"
    return f"{photographs}, {totals.faces} face{'s' * (totals.faces != 1)} {done}"


def _describe_failures(totals: Totals, done: str) -> str:
    """How many failed; the reasons are told if any of them is not the usual one."""
    words = f"{totals.failures.total()} not {done}"
    if set(totals.failures) <= {_UNREADABLE}:
        return words
    counts = ", ".join(f"{count} {reason}" for reason, count in sorted(totals.failures.items()))
    return f"{words} ({counts})"


def _name_reason(error: Exception) -> str:
    if isinstance(error, NoFaceError):
        return _FACELESS
    return _UNWRITTEN if isinstance(error, NotWrittenError) else _UNREADABLE
