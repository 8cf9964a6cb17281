"""Small steps shared by what paints the twin's pictures."""

from torch import Tensor


def column(value: Tensor) -> Tensor:
    """A number per picture as [batch, 1, 1, 1]."""
    return value[:, None, None, None]


def soft_step(value: Tensor, width: float) -> Tensor:
    """0 well below zero, 1 well above, over about `width`."""
    return (value / width * 2).sigmoid()
