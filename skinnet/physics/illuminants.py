"""CIE daylight of any temperature, with a gradient."""

import torch
from jaxtyping import Float
from torch import Tensor

from skinnet.physics._tables import read_table

_UP_TO_7000_K = (-4.6070e9, 2.9678e6, 0.09911e3, 0.244063)
_ABOVE_7000_K = (-2.0064e9, 1.9018e6, 0.24748e3, 0.237040)
"""Coefficients of T^-3, T^-2, T^-1 and 1 in the chromaticity x of daylight."""


def daylight(
    temperature: Float[Tensor, "*batch"],
    components: Float[Tensor, "3 wavelength"] | None = None,
) -> Float[Tensor, "*batch wavelength"]:
    """Compute the relative power of CIE daylight.

    The standard rounds the weights of the components. They are not rounded here, so that they have
    a gradient.

    Args:
        temperature: Correlated colour temperature, 4,000 to 25,000 K.
        components: S0, S1 and S2 of the D series at the bands wanted; None: at the 33 bands.

    Returns:
        Power of unit sum.

    Source:
        CIE 015:2018, equations 4.5 to 4.9.

    Example:
        >>> import torch
        >>> from skinnet.physics import daylight
        >>> warm, cold = daylight(torch.tensor([5000.0, 9000.0]))
        >>> bool(cold[5] / cold[25] > warm[5] / warm[25])  # 450 nm over 650 nm
        True
    """
    if components is None:
        components = torch.stack(list(read_table("daylight").values())).to(temperature)
    x = torch.where(
        temperature <= 7000, _cubic(temperature, _UP_TO_7000_K), _cubic(temperature, _ABOVE_7000_K)
    )
    y = -3.0 * x**2 + 2.870 * x - 0.275
    m = 0.0241 + 0.2562 * x - 0.7341 * y
    m1 = (-1.3515 - 1.7703 * x + 5.9114 * y) / m
    m2 = (0.0300 - 31.4424 * x + 30.0717 * y) / m
    power = components[0] + m1[..., None] * components[1] + m2[..., None] * components[2]
    return power / power.sum(-1, keepdim=True)


def _cubic(temperature: Tensor, weights: tuple[float, ...]) -> Tensor:
    cubic, square, linear, constant = weights
    # In units of 1,000 K: powers of a temperature in kelvin overflow float16 and lose digits in
    # float32.
    t = 1000.0 / temperature
    return cubic * 1e-9 * t**3 + square * 1e-6 * t**2 + linear * 1e-3 * t + constant
