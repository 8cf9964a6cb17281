"""Places are handed out in order and within a window, and turns go by the names of results."""

import threading

import pytest

from skinnet.images._walk import Found
from skinnet.inference._workers.outcome import Outcome
from skinnet.inference._workers.pool import _find_key
from skinnet.inference._workers.schedule import Schedule


def test_no_more_are_in_work_than_the_window_allows() -> None:
    schedule = Schedule("abcd", 2)
    assert (schedule.take(), schedule.take()) == (0, 1)
    third = threading.Thread(target=schedule.take)
    third.start()
    schedule.finish(1, Outcome(value="b"))
    third.join(0.05)
    assert third.is_alive()
    schedule.finish(0, Outcome(value="a"))
    assert schedule.get(0).value == "a"
    third.join()
    assert schedule.get(1).value == "b"
    assert (schedule.take(), schedule.take()) == (3, None)


def test_a_turn_comes_when_the_one_before_of_the_same_names_is_finished() -> None:
    schedule = Schedule("aba", 3)
    schedule.wait_turn(0)
    schedule.wait_turn(1)
    last = threading.Thread(target=schedule.wait_turn, args=(2,))
    last.start()
    last.join(0.05)
    assert last.is_alive()
    schedule.finish(0, Outcome())
    last.join()


def test_a_fault_ends_the_run_after_what_was_finished() -> None:
    schedule = Schedule("ab", 2)
    schedule.finish(0, Outcome(value=1))
    schedule.fail(OSError("no memory"))
    assert schedule.get(0).value == 1
    with pytest.raises(OSError, match="no memory"):
        schedule.get(1)
    assert schedule.take() is None


@pytest.mark.parametrize(
    ("one", "other", "one_folder", "same"),
    [
        ("x/a.jpg", "x/A.png", False, True),
        ("x/a.jpg", "x/a-2.jpg", False, True),
        ("x/a.jpg", "x/a_face1.jpg", False, True),
        ("x/a_face1-2.jpg", "x/a.jpg", False, True),
        ("x/a.jpg", "./x/a.png", False, True),
        ("x/a.jpg", "y/a.jpg", False, False),
        ("x/a.jpg", "y/a.jpg", True, True),
        ("x/IMG-0001.jpg", "x/IMG-0002.jpg", True, False),
        ("x/a.jpg", "x/b.jpg", False, False),
    ],
)
def test_photographs_whose_results_may_want_the_same_names(
    one: str, other: str, one_folder: bool, same: bool
) -> None:
    assert (_find_key(Found(one), one_folder) == _find_key(Found(other), one_folder)) is same
