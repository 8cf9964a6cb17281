"""Small steps shared by what paints a synthetic portrait."""

from torch import Tensor


def column(value: Tensor) -> Tensor:
    """A number per scene as [batch, 1, 1, 1]."""
    return value[:, None, None, None]


def soft_step(value: Tensor, width: float) -> Tensor:
    """0 well below zero, 1 well above, over about `width`."""
    return (value / width * 2).sigmoid()
