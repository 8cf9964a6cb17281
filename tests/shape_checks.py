"""Checks of shapes and types by jaxtyping and beartype at a third of their cost.

jaxtyping checks arguments before a call and, with what is returned, after it; here they are checked
once. In a loop of thousands of calls, checks would take most of the time of a test: a function is
checked in its first `LIMIT` calls in each test, and not thereafter.
"""

from collections.abc import Callable
from functools import wraps
from types import FunctionType
from typing import Any

import jaxtyping
from beartype import beartype

LIMIT = 300
"""Calls of one function in one test that are checked."""

_counts: list[list[int]] = []
_jaxtyped = jaxtyping.jaxtyped


def install() -> None:
    """Check functions and classes of skinnet as they are loaded."""
    jaxtyping.jaxtyped = _decorate
    jaxtyping.install_import_hook("skinnet", f"{__name__}.check")


def start_test() -> None:
    """Check the next calls of every function again."""
    for count in _counts:
        count[0] = 0


def check(function: Callable[..., Any]) -> Callable[..., Any]:
    """Check the arguments, or else what is returned.

    For each function, jaxtyping makes one that has its arguments, and one that has its arguments
    and what it returns. The first is called first, and the axes that it has found are kept.
    """
    returned = function.__annotations__.get("return", Any)
    if returned is not Any:
        function.__annotations__ = {"return": returned}
    return beartype(function)


def _decorate(*given: Any, **options: Any) -> Any:
    decorate = _jaxtyped(*given, **options)
    return decorate if given else lambda one: _limit(one, decorate(one))


def _limit(function: Any, checked: Any) -> Any:
    if not isinstance(function, FunctionType):
        return checked
    count = [0]
    _counts.append(count)

    @wraps(function)
    def call(*arguments: Any, **options: Any) -> Any:
        if count[0] >= LIMIT:
            return function(*arguments, **options)
        count[0] += 1
        return checked(*arguments, **options)

    return call
