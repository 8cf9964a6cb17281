"""Arrays of shape models as numbers, and nothing else that a file may hold."""

from typing import Any

import numpy as np
from jaxtyping import Float, Int
from numpy.typing import NDArray


def to_floats(array: Any) -> Float[np.ndarray, "..."]:
    """Convert to float64; a float32 basis stays float32, to save memory.

    Raises:
        ValueError: The array is of text, complex numbers or others that are no real numbers.
    """
    values = _check_kind(array, "fiu")
    with np.errstate(invalid="ignore"):  # of NaN, which the model refuses
        return values if values.dtype == np.float32 else values.astype(np.float64)


def to_indices(array: Any) -> Int[np.ndarray, "..."]:
    """Convert to int64; floats that are whole numbers too, which MATLAB writes.

    Raises:
        ValueError: A value is no whole number.
    """
    values = _check_kind(array, "fiu")
    if values.dtype.kind == "f" and not (np.abs(values) < 2**53).all():
        raise ValueError("an index is no number, or too large")
    indices: NDArray[np.int64] = values.astype(np.int64)
    if (indices != values).any():
        raise ValueError("an index is no whole number")
    return indices


def _check_kind(array: Any, kinds: str) -> NDArray[Any]:
    values = np.asarray(array)
    if values.dtype.kind not in kinds:
        raise ValueError(f"an array holds {values.dtype.name}, and numbers are needed")
    return values
