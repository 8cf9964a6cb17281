"""What a spectrophotometer adds to the skin: the reflection at the surface."""

from jaxtyping import Float
from torch import Tensor

R_SURFACE = 0.0504
"""Reflectance of the surface, fitted to measured spectra by `python -m tools.fit_skin`. Fresnel's
equations have .028 for n = 1.4 at normal incidence, and .04 to .06 for diffuse light on a rough
surface."""


def include_specular(
    reflectance: Float[Tensor, "*batch wavelength"],
    r_surface: Float[Tensor, "*#batch"] | float = R_SURFACE,
) -> Float[Tensor, "*batch wavelength"]:
    """Compute what a spectrophotometer measures with the specular component included.

    R_meas = R_s + (1 - R_s) R. The skin itself is R: a photograph has specular reflection of its
    own.

    Args:
        reflectance: Reflectance R of skin, in [0, 1].
        r_surface: Reflectance R_s of the surface, in [0, 1].

    Returns:
        Measured reflectance, in [0, 1].

    Source:
        Saunderson 1942, without reflection from within, which the model's layers include.

    Example:
        >>> import torch
        >>> from skinnet.physics import include_specular
        >>> round(include_specular(torch.tensor([0.5]), 0.05).item(), 6)
        0.525
    """
    if isinstance(r_surface, Tensor):
        r_surface = r_surface[..., None]
    return r_surface + (1 - r_surface) * reflectance
