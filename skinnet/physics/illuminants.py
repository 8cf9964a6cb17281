"""CIE daylight of any temperature, with a gradient."""

import torch
from jaxtyping import Float
from torch import Tensor

from skinnet.physics._tables import read_table

_WARM = (-4.6070e9, 2.9678e6, 0.09911e3, 0.244063)
_COLD = (-2.0064e9, 1.9018e6, 0.24748e3, 0.237040)


def daylight(
    temperature: Float[Tensor, "*batch"],
    components: Float[Tensor, "3 wavelength"] | None = None,
) -> Float[Tensor, "*batch wavelength"]:
    """Relative power of CIE daylight at 4,000 to 25,000 K, each spectrum of unit sum.

    `components` are S0, S1 and S2 of the D series on the bands wanted. CIE 015:2018, equations
    4.5 to 4.9; the weights keep all their digits, so that they have a gradient.
    """
    if components is None:
        components = torch.stack(list(read_table("daylight").values())).to(temperature)
    x = torch.where(temperature <= 7000, _cubic(temperature, _WARM), _cubic(temperature, _COLD))
    y = -3.0 * x**2 + 2.870 * x - 0.275
    m = 0.0241 + 0.2562 * x - 0.7341 * y
    m1 = (-1.3515 - 1.7703 * x + 5.9114 * y) / m
    m2 = (0.0300 - 31.4424 * x + 30.0717 * y) / m
    power = components[0] + m1[..., None] * components[1] + m2[..., None] * components[2]
    return power / power.sum(-1, keepdim=True)


def _cubic(temperature: Tensor, weights: tuple[float, ...]) -> Tensor:
    cubic, square, linear, constant = weights
    # In units of 1,000 K: the powers of a temperature in kelvin leave float16 and strain float32.
    t = 1000.0 / temperature
    return cubic * 1e-9 * t**3 + square * 1e-6 * t**2 + linear * 1e-3 * t + constant
