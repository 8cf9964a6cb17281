"""One case: files, and what is done with them."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from importlib import import_module
from pathlib import Path
from random import Random

from benchmarks.fuzzing import CLASSES

Content = bytes | bytearray


@dataclass(frozen=True)
class Case:
    """Files, and an action on them.

    Attributes:
        run: The action, which gets the folder of the files. It returns, or raises `InputError`;
            everything else is a fault. It asserts what is true of any result.
        files: Contents by name.
        what: A short description of the case.
    """

    run: Callable[[Path], object]
    files: Mapping[str, Content] = field(default_factory=dict)
    what: str = ""


def make_case(kind: str, seed: int) -> Case:
    """Make a case of a class; the same seed makes the same case.

    Args:
        kind: One of `CLASSES`.
        seed: A whole number.
    """
    case: Case = import_module(CLASSES[kind]).make(Random(f"{kind} {seed}"))
    return case
