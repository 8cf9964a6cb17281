"""Which people of the pairs of photographs are kept for testing."""

import hashlib
from collections.abc import Sequence


def choose_kept(people: Sequence[str], kept: int = 100) -> set[str]:
    """Choose the people that no training sees, by a hash of their names.

    Args:
        people: Names, in any order.
        kept: How many are kept; all, if there are fewer.

    Returns:
        Names of those who are kept for testing.

    Example:
        >>> from train.pair_split import choose_kept
        >>> sorted(choose_kept(["Ada", "Bo", "Cy", "Di"], kept=2))
        ['Cy', 'Di']
    """
    return set(sorted(set(people), key=_hash)[:kept])


def _hash(person: str) -> str:
    return hashlib.sha256(person.encode()).hexdigest()
