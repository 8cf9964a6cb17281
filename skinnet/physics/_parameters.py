"""Constants and volume fractions as users hand them in."""

import torch
from jaxtyping import Float
from torch import Tensor, nn

from skinnet.errors import InputError

ROUNDING = 1e-5
"""How far outside [0, 1] a fraction may lie: interpolation and finite differences do that."""


def register_constant(
    module: nn.Module,
    name: str,
    value: float | Tensor | None,
    dtype: torch.dtype,
    persistent: bool = True,
) -> None:
    """Register `value` under `name`: an `nn.Parameter` as itself, anything else as a buffer."""
    if isinstance(value, nn.Parameter):
        module.register_parameter(name, value)
    elif value is None:
        module.register_buffer(name, None)
    else:
        constant = torch.as_tensor(value, dtype=dtype).clone(memory_format=torch.contiguous_format)
        module.register_buffer(name, constant, persistent)


def check_fraction(
    name: str, value: Float[Tensor, "*batch"] | float, like: Tensor
) -> Float[Tensor, "*batch"]:
    """A volume fraction as a floating-point tensor on the device of `like`.

    Raises `InputError`, a `ValueError`, where a value is not a number or lies outside [0, 1]. In a
    graph that is being compiled or exported nothing is checked.
    """
    floating = isinstance(value, Tensor) and value.is_floating_point()
    fraction = torch.as_tensor(value, dtype=None if floating else like.dtype, device=like.device)
    if torch.compiler.is_compiling() or not fraction.numel():
        return fraction
    low, high = (float(bound) for bound in fraction.detach().aminmax())
    if not (low >= -ROUNDING and high <= 1 + ROUNDING):
        raise InputError(_sentence(name, high if low >= -ROUNDING else low))
    return fraction


def _sentence(name: str, value: float) -> str:
    hint = " Was it given in percent?" if value > 1 else ""
    return f"{name} is a volume fraction in [0, 1]; got {value:g}.{hint}"
