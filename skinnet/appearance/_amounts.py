"""Amounts of states: what they may be, and the coefficients that they stand for."""

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from skinnet.errors import InputError
from skinnet.images._arguments import check_number

Amounts = Mapping[str, int | float]


def check_amounts(amounts: Amounts, states: Mapping[str, Amounts], names: Sequence[str]) -> None:
    """Refuse states that are not known, and amounts that are not from 0 to 1.

    Raises:
        InputError: For the first one.
    """
    for name, amount in amounts.items():
        if name not in states and name not in names:
            others = "" if not names or set(names) <= {*states} else ", or a coefficient of it"
            known = ", ".join(states or names)
            raise InputError(f"The model has no state {name!r:.60}; it has {known}{others}.")
        number = check_number(f"The amount of {name}", amount)
        if not 0 <= number <= 1:
            raise InputError(
                f"The amount of {name} is a number from 0 (at rest) to 1 (as far as the model "
                f"goes); got {number:g}. Was it given in percent?"
            )


def join_states(
    amounts: Amounts, states: Mapping[str, Amounts], names: Sequence[str]
) -> NDArray[np.float64]:
    """Add up the coefficients that amounts of states stand for, each at most 1, [names].

    A coefficient that is given by its own name goes before a state of that name.
    """
    joined = np.zeros(len(names))
    for name, amount in amounts.items():
        parts = {name: 1.0} if name in names else states[name]
        for each, share in parts.items():
            joined[names.index(each)] += share * amount
    return joined.clip(0, 1)
