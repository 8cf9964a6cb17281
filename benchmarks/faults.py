"""Damaged and hostile inputs of every class: how many are tried, and how many survived.

A case has survived if it ends with a result or with a sentence, within 5 s and 2 GB. Every case is
made from its class and a seed; `--only CLASS --seed SEED --cases 1` runs it again.
"""

import argparse
import json
import sys
import time
from collections.abc import Iterator, Sequence

from benchmarks import report
from benchmarks.fuzzing import CLASSES
from benchmarks.fuzzing.runner import Outcome, Runner
from skinnet.errors import InputError

_CASES = 100


def main(arguments: Sequence[str] | None = None) -> int:
    """Run cases, print figures, and the faults on standard error.

    Returns:
        The exit code: 0, 1 if a case has not survived, or 2 for bad input.
    """
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--json", action="store_true", help="print one JSON object")
    parser.add_argument("--only", metavar="CLASS", help=f"one of {', '.join(CLASSES)}")
    parser.add_argument("--seed", type=int, default=0, metavar="N", help="first seed; 0 by default")
    budget = parser.add_mutually_exclusive_group()
    budget.add_argument(
        "--cases", type=int, metavar="N", help=f"cases of each class; {_CASES} by default"
    )
    budget.add_argument("--minutes", type=float, metavar="X", help="time for all classes together")
    options = parser.parse_args(arguments)
    try:
        results = measure(options.only, options.seed, options.cases, options.minutes)
    except InputError as error:
        print(f"\n{error}", file=sys.stderr)
        return 2
    print(json.dumps(results) if options.json else report.format_table(results))
    return int(results["survived"] < results["tried"])


def measure(
    only: str | None = None, seed: int = 0, cases: int | None = None, minutes: float | None = None
) -> report.Results:
    """Run cases of each class, in turn.

    Args:
        only: The class; None for all.
        seed: The first seed of each class.
        cases: Cases of each class; `_CASES` by default.
        minutes: Time for all classes, in place of a number of cases.

    Returns:
        `tried`, `survived`, `results` (those that did not end with a sentence), `slowest_seconds`
        and `peak_gb` of all and of each class.

    Raises:
        InputError: There is no such class, or no time.
    """
    if only is not None and only not in CLASSES:
        raise InputError(f"There is no class {only}; the classes are {', '.join(CLASSES)}.")
    if min(1 if cases is None else cases, 1 if minutes is None else minutes) <= 0:
        raise InputError("The budget is more than nothing: give --cases from 1, or --minutes.")
    kinds = [only] if only else list(CLASSES)
    with Runner() as runner:
        outcomes = list(_run(runner, kinds, seed, cases, minutes))
    found = {kind: [each for each in outcomes if each.kind == kind] for kind in kinds}
    return {**_summarise(outcomes), **{kind: _summarise(each) for kind, each in found.items()}}


def _run(
    runner: Runner, kinds: Sequence[str], seed: int, cases: int | None, minutes: float | None
) -> Iterator[Outcome]:
    started = time.monotonic()
    count = sys.maxsize if minutes is not None else cases or _CASES
    for number in range(count):
        for kind in kinds:
            if minutes is not None and time.monotonic() - started > 60 * minutes:
                return
            outcome = runner.run(kind, seed + number)
            if not outcome.survived:
                print(outcome.describe(), file=sys.stderr, flush=True)
            yield outcome._replace(message="")


def _summarise(outcomes: Sequence[Outcome]) -> report.Results:
    return {
        "tried": len(outcomes),
        "survived": sum(each.survived for each in outcomes),
        "results": sum(each.end == "result" for each in outcomes),
        "slowest_seconds": round(max((each.seconds for each in outcomes), default=0), 2),
        "peak_gb": round(max((each.peak_gb for each in outcomes), default=0), 2),
    }


if __name__ == "__main__":
    sys.exit(main())
