"""Small tensor functions that the synthetic renderer shares."""

import numpy as np
import torch
from jaxtyping import Float
from numpy.typing import ArrayLike
from torch import Tensor


def make_tensors(**values: ArrayLike) -> dict[str, Tensor]:
    """Turn named numbers and arrays into tensors of their own dtype."""
    return {name: torch.from_numpy(np.asarray(value)) for name, value in values.items()}


def make_float_tensors(**values: ArrayLike) -> dict[str, Tensor]:
    """Turn named numbers and arrays into tensors of float32."""
    return {name: torch.from_numpy(np.asarray(value, np.float32)) for name, value in values.items()}


def expand_scalar(value: Float[Tensor, "batch"]) -> Float[Tensor, "batch 1 1 1"]:
    """Give a number per picture the axes of an image."""
    return value[:, None, None, None]


def expand_colour(value: Float[Tensor, "batch 3"]) -> Float[Tensor, "batch 3 1 1"]:
    """Give a colour per picture the axes of an image."""
    return value[:, :, None, None]


def soft_step(value: Tensor, width: float) -> Tensor:
    """Step from 0 to 1 where the value changes sign, over about `width`."""
    return (value / width * 2).sigmoid()


def normalise(vectors: Float[Tensor, "batch 3 *shape"]) -> Float[Tensor, "batch 3 *shape"]:
    """Divide vectors along axis 1 by their length; many times faster on a CPU than F.normalize."""
    return vectors * (vectors**2).sum(1, keepdim=True).rsqrt()
