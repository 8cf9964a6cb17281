"""What a spectrophotometer adds to the skin: the reflection at the surface."""

import torch
from jaxtyping import Float
from torch import Tensor

from skinnet.errors import InputError

R_SURFACE = 0.0504
"""Reflectance of the surface, fitted to measured spectra by `python -m tools.fit_skin`. Fresnel's
equations have .028 for n = 1.4 at normal incidence, and .04 to .06 for diffuse light on a rough
surface."""

_ROUNDING = 1e-5
"""How far outside [0, 1] R_s may lie because of finite differences."""


def include_specular(
    reflectance: Float[Tensor, "*batch wavelength"],
    r_surface: Float[Tensor, "*#batch"] | float = R_SURFACE,
) -> Float[Tensor, "*batch wavelength"]:
    """Compute what a spectrophotometer measures with the specular component included.

    R_meas = R_s + (1 - R_s) R. The skin itself is R: a photograph has specular reflection of its
    own.

    Args:
        reflectance: Reflectance R of skin, in [0, 1].
        r_surface: Reflectance R_s of the surface, in [0, 1], the same at all bands.

    Returns:
        Measured reflectance, in [0, 1].

    Raises:
        InputError: For a reflectance of the surface out of its range, or of another shape.

    Source:
        Saunderson 1942, without reflection from within, which the model's layers include.

    Example:
        >>> import torch
        >>> from skinnet.physics import include_specular
        >>> round(include_specular(torch.tensor([0.5]), 0.05).item(), 6)
        0.525
    """
    surface = torch.as_tensor(r_surface, dtype=reflectance.dtype, device=reflectance.device)
    wrong = surface.detach()[~((surface.detach() - 0.5).abs() <= 0.5 + _ROUNDING)]
    if wrong.numel():
        raise InputError(
            f"r_surface is a reflectance in [0, 1]; got {wrong[0]:g}. Was it given in percent?"
        )
    if surface.ndim >= reflectance.ndim:
        raise InputError(
            f"r_surface has one value for each spectrum; got shape {tuple(surface.shape)} for "
            f"spectra of shape {tuple(reflectance.shape)}."
        )
    r_surface = surface[..., None]
    return r_surface + (1 - r_surface) * reflectance
