"""What becomes of the inputs of a run is counted and told."""

from collections import Counter

import pytest

from skinnet.errors import InputError, NoFaceError
from skinnet.images._kind import OTHER
from skinnet.images._walk import Found, PassedOver, Walk
from skinnet.inference._input_run import (
    NotWrittenError,
    Totals,
    describe_totals,
    is_one_file,
    run_over,
)

FAULTS: dict[str, Exception] = {
    "b": InputError("b is damaged."),
    "c": NoFaceError("No face was found in c."),
    "d": NotWrittenError("out cannot be written."),
    "e": OSError(5, "Input/output error", "e"),
}


def work(found: Found) -> int:
    if found.path in FAULTS:
        raise FAULTS[found.path]
    return 2


def test_faults_are_handed_over_and_the_rest_goes_on() -> None:
    failed: list[tuple[str, Exception]] = []
    absent = InputError("There is no file x.")
    found = Walk([*map(Found, "abcdef"), Found("x", absent)])
    totals = run_over(found, work, lambda *each: failed.append(each))
    assert failed == [*FAULTS.items(), ("x", absent)]
    assert (totals.photographs, totals.faces) == (2, 4)
    assert totals.failures == Counter(
        {"could not be read": 3, "without a face": 1, "could not be written": 1}
    )


@pytest.mark.parametrize("error", [BrokenPipeError(), KeyboardInterrupt(), ZeroDivisionError()])
def test_other_faults_end_the_run(error: BaseException) -> None:
    def fail(_: Found) -> int:
        raise error

    with pytest.raises(type(error)):
        run_over(Walk([Found("a")]), fail, lambda *_: None)


def test_the_total_has_count_rate_and_place() -> None:
    totals = Totals(38, 41, Counter({"could not be read": 2}), 40 / 1.9)
    assert describe_totals(totals, Walk(), "read", "maps in skinmaps") == (
        "38 photographs, 41 faces read, 2 not read, 1.9 per second: maps in skinmaps."
    )


def test_the_total_names_other_reasons_and_what_was_passed_over() -> None:
    totals = Totals(1, 0, Counter({"without a face": 1, "could not be read": 1}), 2.0)
    found = Walk(passed_over=[PassedOver("folder/a.txt", OTHER)])
    assert describe_totals(totals, found, "edited") == (
        "1 photograph edited, 2 not edited (1 could not be read, 1 without a face), 1 passed over, "
        "1.5 per second. Passed over: 1 other file (a.txt)."
    )


def test_a_run_in_which_nothing_was_read_names_no_place() -> None:
    totals = Totals(failures=Counter({"could not be read": 3}), seconds=1.0)
    assert describe_totals(totals, Walk(), where="maps in a") == "0 photographs read, 3 not read."


def test_one_named_file_needs_no_total() -> None:
    assert is_one_file(Walk([Found("a.jpg")]), ["a.jpg"])
    assert not is_one_file(Walk([Found("folder/a.jpg")]), ["folder"])
    assert not is_one_file(Walk([Found("a.jpg")]), ["a.jpg", "a.jpg"])
