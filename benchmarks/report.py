"""Prints the figures of a benchmark, as a short table or as one JSON object."""

import argparse
import json
import sys
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

from skinnet.errors import InputError

Results = dict[str, Any]


def main(
    measure: Callable[..., Results],
    description: str,
    layout: Callable[[Results], str] | None = None,
    paths: Mapping[str, str] | None = None,
    counts: Mapping[str, str] | None = None,
) -> None:
    """Measure, then print the figures.

    Bad input ends with a sentence and exit code 2.

    Args:
        measure: Makes the figures.
        description: Help text of the command.
        layout: Makes a table of the figures; without it each has a line of its own. `--json` prints
            one object instead.
        paths: Help text of each option that takes a path, by its name: `--NAME PATH` is the keyword
            `NAME` of `measure`, and None where it is not given.
        counts: The same for each option that takes a whole number; where it is not given, `measure`
            has its default.
    """
    parser = argparse.ArgumentParser(description=description)
    parser.add_argument("--json", action="store_true", help="print one JSON object")
    for name, text in (paths or {}).items():
        parser.add_argument(f"--{name}", type=Path, metavar="PATH", help=text)
    for name, text in (counts or {}).items():
        parser.add_argument(
            f"--{name}", type=int, metavar="N", help=text, default=argparse.SUPPRESS
        )
    given = vars(parser.parse_args())
    as_json = given.pop("json")
    try:
        results = measure(**given)
    except InputError as error:
        print(f"\n{error}", file=sys.stderr)
        sys.exit(2)
    print(json.dumps(results) if as_json else (layout or format_table)(results))


def format_table(results: Mapping[str, Any]) -> str:
    """Format each number as a line, with its path on the left."""
    lines = list(_format_lines(results))
    width = max(len(name) for name, _ in lines)
    return "\n".join(f"{name:{width}}  {value}" for name, value in lines)


def _format_lines(results: Mapping[str, Any], prefix: str = "") -> Iterator[tuple[str, str]]:
    for name, value in results.items():
        if isinstance(value, Mapping):
            yield from _format_lines(value, f"{prefix}{name}.")
        else:
            yield prefix + name, f"{value:.4g}" if isinstance(value, float) else str(value)
