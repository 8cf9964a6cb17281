"""The dermis: diffuse reflectance of a scattering layer over a black substrate (Kubelka-Munk)."""

import torch
from jaxtyping import Float
from torch import Tensor


def kubelka_munk(
    k: Float[Tensor, "*shape"], s: Float[Tensor, "*#shape"], d: Float[Tensor, "*#shape"]
) -> Float[Tensor, "*shape"]:
    """Compute the diffuse reflectance of a layer over a black substrate.

    R = s / (k + s + K coth(K d)) with K^2 = k (k + 2 s). This is the expression of the paper with
    the denominator (1 + beta)^2 e^{Kd} - (1 - beta)^2 e^{-Kd}. It neither overflows nor divides
    zero by zero, and is s d / (1 + s d) where k = 0. The printed denominator has (1 + beta^2) and
    (1 - beta^2), a misprint: it gives R = 1 for any layer that does not absorb.

    Args:
        k: Absorption, cm^-1, at least 0.
        s: Scattering, cm^-1, above 0.
        d: Thickness, cm, above 0.

    Returns:
        Reflectance in [0, 1].

    Source:
        Section 3.3 of Alotaibi & Smith 2017 (R_dermis).

    Example:
        >>> import torch
        >>> from skinnet.physics import kubelka_munk
        >>> k, s, d = torch.tensor(0.0), torch.tensor(20.0), torch.tensor(0.2)
        >>> round(kubelka_munk(k, s, d).item(), 6)  # s d / (1 + s d)
        0.8
    """
    return s / (k + s + _x_coth_x(k * (k + 2 * s) * d**2) / d)


def _kubelka_munk_printed(
    k: Float[Tensor, "*shape"], s: Float[Tensor, "*#shape"], d: Float[Tensor, "*#shape"]
) -> Float[Tensor, "*shape"]:
    """The same layer with the denominator that section 3.3 misprints, for comparison only."""
    beta2 = k / (k + 2 * s)
    decay = torch.exp(-2 * torch.sqrt(k * (k + 2 * s)) * d)
    return (1 - beta2) * (1 - decay) / ((1 + beta2) - (1 - beta2) * decay)


def _x_coth_x(x2: Float[Tensor, "*shape"]) -> Float[Tensor, "*shape"]:
    """Return x coth(x) as a function of x^2 >= 0, smooth at zero, where it is 1 + x^2 / 3."""
    small = x2 < 1e-4
    x = torch.sqrt(torch.where(small, torch.ones_like(x2), x2))
    return torch.where(small, 1 + x2 / 3 - x2**2 / 45, x / torch.tanh(x))
