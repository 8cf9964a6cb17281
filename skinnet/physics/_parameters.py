"""Checks of constants and volume fractions as users hand them in."""

import torch
from jaxtyping import Float
from torch import Tensor, nn

from skinnet.errors import InputError
from skinnet.physics.nuisance import Nuisance

_ROUNDING = 1e-5
"""How far outside [0, 1] a fraction may lie because of interpolation and finite differences."""


def register_constant(
    module: nn.Module,
    name: str,
    value: float | Tensor | None,
    dtype: torch.dtype,
    persistent: bool = True,
) -> None:
    """Register a value: an `nn.Parameter` as itself, anything else as a buffer."""
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
    """Return a volume fraction as a floating-point tensor on the device of `like`.

    Nothing is checked in a graph that is being compiled or exported.

    Raises:
        InputError: Where a value is not a number or lies outside [0, 1].
    """
    floating = isinstance(value, Tensor) and value.is_floating_point()
    fraction = torch.as_tensor(value, dtype=None if floating else like.dtype, device=like.device)
    if torch.compiler.is_compiling() or not fraction.numel():
        return fraction
    low, high = (float(bound) for bound in fraction.detach().aminmax())
    if not (low >= -_ROUNDING and high <= 1 + _ROUNDING):
        wrong = high if low >= -_ROUNDING else low
        hint = " Was it given in percent?" if wrong > 1 else ""
        raise InputError(f"{name} is a volume fraction in [0, 1]; got {wrong:g}.{hint}")
    return fraction


_LARGEST = {"thickness": 10.0, "scattering": 10.0, "oxygenation": 1.0, "baseline": 10.0}
"""Deviations that are larger are a slip, such as percent. A factor of e^10 is beyond any skin."""


def check_nuisance(nuisance: Nuisance, like: Tensor) -> Nuisance:
    """Return deviations as tensors on the device of `like`.

    Nothing is checked in a graph that is being compiled or exported.

    Raises:
        InputError: For what is no `Nuisance`, and for a deviation that is NaN or too large.
    """
    if not isinstance(nuisance, Nuisance):
        raise InputError(f"A skin's deviations are a Nuisance; got {type(nuisance).__name__}.")
    deviations = Nuisance(
        *(
            one if isinstance(one, Tensor) else torch.as_tensor(one, dtype=like.dtype)
            for one in nuisance
        )
    )
    if torch.compiler.is_compiling():
        return deviations
    for (name, most), value in zip(_LARGEST.items(), deviations, strict=True):
        wrong = value.detach()[~(value.detach().abs() <= most)]
        if wrong.numel():
            raise InputError(
                f"{name} is a deviation from the preset in [-{most:g}, {most:g}]; got "
                f"{wrong.flatten()[0]:g}."
            )
    return deviations
