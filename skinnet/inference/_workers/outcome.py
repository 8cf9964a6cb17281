"""What a worker process makes of a photograph, for the process of the command."""

import pickle
import traceback
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

from skinnet.files._partial import add_removed, take_removed
from skinnet.images._walk import Found
from skinnet.inference._messages import Line, print_recorded, record_lines


class Outcome(NamedTuple):
    """What became of a photograph.

    Attributes:
        lines: What was printed.
        value: What the work returned; None if it failed.
        error: Why it failed, or None.
        removed: Partial files of interrupted runs that were removed.
    """

    lines: tuple[Line, ...] = ()
    value: Any = None
    error: Exception | None = None
    removed: tuple[Path, ...] = ()

    def replay(self) -> Any:
        """Print the lines; return the value or raise the error."""
        add_removed(self.removed)
        print_recorded(self.lines)
        if self.error is not None:
            raise self.error
        return self.value


def record(work: Callable[[Found], Any], picture: Found) -> Outcome:
    """Do the work on a photograph, and keep what it prints, returns or raises."""
    value, fault = None, None
    with record_lines() as lines:
        try:
            value = work(picture)
        except Exception as error:
            fault = _make_portable(error)
    return Outcome(tuple(lines), value, fault, tuple(take_removed()))


def _make_portable(error: Exception) -> Exception:
    """An error that another process can raise, with the traceback of this one as a note."""
    error.add_note("".join(traceback.format_exception(error)))
    try:
        pickle.loads(pickle.dumps(error))
    except Exception:
        return RuntimeError(f"{type(error).__name__}: {error}")
    return error
