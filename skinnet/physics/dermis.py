"""Diffuse reflectance of a scattering layer over a black substrate (Kubelka-Munk)."""

import torch
from jaxtyping import Float
from torch import Tensor


def kubelka_munk(
    k: Float[Tensor, "*shape"], s: Float[Tensor, "*#shape"], d: Float[Tensor, "*#shape"]
) -> Float[Tensor, "*shape"]:
    """Reflectance in [0, 1] of a layer of absorption k, scattering s (cm^-1), thickness d (cm).

    R = s / (k + s + K coth(K d)) with K^2 = k (k + 2 s). It is the expression of section 3.3 of the
    paper with the denominator (1 + beta)^2 e^{Kd} - (1 - beta)^2 e^{-Kd}; it neither overflows nor
    divides zero by zero, and gives s d / (1 + s d) where k = 0.
    """
    return s / (k + s + x_coth_x(k * (k + 2 * s) * d**2) / d)


def kubelka_munk_printed(
    k: Float[Tensor, "*shape"], s: Float[Tensor, "*#shape"], d: Float[Tensor, "*#shape"]
) -> Float[Tensor, "*shape"]:
    """The same layer with the paper's misprinted denominator, for the record only.

    It prints (1 + beta^2) and (1 - beta^2), which gives R = 1 for any layer that does not absorb.
    """
    beta2 = k / (k + 2 * s)
    decay = torch.exp(-2 * torch.sqrt(k * (k + 2 * s)) * d)
    return (1 - beta2) * (1 - decay) / ((1 + beta2) - (1 - beta2) * decay)


def x_coth_x(x2: Float[Tensor, "*shape"]) -> Float[Tensor, "*shape"]:
    """x coth(x) as a function of x^2 >= 0, smooth at zero, where it is 1 + x^2 / 3."""
    small = x2 < 1e-4
    x = torch.sqrt(torch.where(small, torch.ones_like(x2), x2))
    return torch.where(small, 1 + x2 / 3 - x2**2 / 45, x / torch.tanh(x))
