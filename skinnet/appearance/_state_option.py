"""The option --state of `skinnet edit`."""

import argparse
from collections.abc import Iterable

from skinnet.appearance.dynamic import DynamicModel
from skinnet.errors import InputError


def read_states(options: argparse.Namespace) -> None:
    """Replace the words of --state by the change of blood that they ask for.

    Raises:
        InputError: A state is not known or given twice, or an amount is no number from 0 to 1.
    """
    if not options.state:
        options.state = None
        return
    model, amounts = DynamicModel.load(), {}
    for name, word in options.state:
        if name not in model.states:
            raise InputError(f"There is no state {name!r:.60}; states are {_list(model.states)}.")
        if name in amounts:
            raise InputError(f"--state {name} is given twice; give one amount.")
        amounts[name] = _read_amount(name, word)
    options.state = model.change(amounts)


def _read_amount(name: str, word: str) -> float:
    try:
        return float(word)
    except ValueError as error:
        raise InputError(
            f"The amount of {name} is a number from 0 to 1; got {word!r:.60}. Write it after the "
            f"name, such as --state {name} 0.7."
        ) from error


def _list(names: Iterable[str]) -> str:
    *words, last = names
    return f"{', '.join(words)} and {last}"
