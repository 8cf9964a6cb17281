"""The columns of the rows that a batch writes, for those who read them."""

from collections.abc import Mapping, Sequence
from typing import Any

from skinnet.batch._columns import flatten, list_columns


def describe_columns(lights: Sequence[str] = (), maps: bool = False) -> dict[str, str]:
    """Describe the columns that `python -m skinnet.batch` writes.

    Args:
        lights: Names of the lights of the model, each of which has a column for its weight.
        maps: Whether the maps are among them, as with --maps.

    Returns:
        What each column holds, by its name, in order.

    Example:
        >>> from skinnet.batch import describe_columns
        >>> describe_columns()["pigments_melanin_mean"]
        'melanin: mean volume fraction'
    """
    return {name: description for name, _, description in list_columns(lights, maps)}


def flatten_summary(summary: Mapping[str, Any]) -> dict[str, Any]:
    """Flatten the summary of a face, so that each number has a name of its own.

    Args:
        summary: What `Decomposition.to_dict` returns, or the JSON that `skinnet predict` writes.

    Returns:
        Values by the keys that lead to them, joined by `_`. The two ends of an interval are
        `..._interval_low` and `..._interval_high`. Units, which are the same in every row, are
        left out.

    Example:
        >>> from skinnet.batch import flatten_summary
        >>> flatten_summary({"pigments": {"melanin": {"mean": 0.03, "interval": [0.02, 0.05]}}})
        {'pigments_melanin_mean': 0.03, 'pigments_melanin_interval_low': 0.02,
         'pigments_melanin_interval_high': 0.05}
    """
    return dict(flatten(summary, ""))
