"""Checks of shapes and types by beartype, each argument once: jaxtyping asks for them twice."""

from collections.abc import Callable
from typing import Any

from beartype import beartype


def check(function: Callable[..., Any]) -> Callable[..., Any]:
    """Check the arguments, or else what is returned.

    For each function, jaxtyping makes one that has its arguments, and one that has its arguments and
    what it returns. The first is called first, and the axes that it has found are kept.
    """
    returned = function.__annotations__.get("return", Any)
    if returned is not Any:
        function.__annotations__ = {"return": returned}
    return beartype(function)
