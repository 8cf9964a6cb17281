"""White balances, log R/G and log B/G, of one photograph that were found in two ways."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

MOST_APART = 0.12
"""Difference of log R/G or log B/G of a picture's own reference from a profile that is noted."""

MOST_BLIND = 0.3
"""The same between what is read of a face without a profile, and the profile; portraits without one
are within 0.15."""


def is_apart(own: Sequence[float], other: Sequence[float] | NDArray[Any], most: float) -> bool:
    """Whether log R/G or log B/G of two white balances differ by more than the largest."""
    return bool(np.abs(np.subtract(own, other)).max() > most)


def format_balance(balance: Sequence[float] | NDArray[Any]) -> str:
    """Write log R/G and log B/G with two digits."""
    return ", ".join(f"{one:.2f}" for one in balance)
