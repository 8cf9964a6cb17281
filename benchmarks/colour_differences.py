"""Colours of spectra by colour-science, a path of its own beside that of `skinnet.physics`."""

import warnings

import numpy as np
import torch
from jaxtyping import Float
from torch import Tensor

from benchmarks.skin_spectra import fill_bands
from skinnet.physics import WAVELENGTHS

with warnings.catch_warnings():
    warnings.simplefilter("ignore")  # It warns of optional packages that nothing here needs.
    import colour

LIGHTS = ("A", "FL11", "LED-B3")
"""Lights other than D65, for which colours of recovered spectra are compared."""

STEP = 5
"""Steps of the integration in nm: those of the CIE's table of fluorescent lamps."""


def compute_lab(
    reflectance: Float[Tensor, "people wavelength"], light: str = "D65"
) -> Float[Tensor, "people 3"]:
    """Compute CIE 1976 L*a*b* of reflectance under a CIE illuminant.

    The observer is that of CIE 1931, 2 degrees; white is the perfect diffuser under the same light.
    """
    nm = WAVELENGTHS.numpy()
    fine = np.arange(nm[0], nm[-1] + 1, STEP)
    shape = colour.SpectralShape(fine[0], fine[-1], STEP)
    observer = colour.MSDS_CMFS["CIE 1931 2 Degree Standard Observer"].copy().align(shape).values
    power = colour.SDS_ILLUMINANTS[light].copy().align(shape).values
    weights = observer * power[:, None] / (observer[:, 1] @ power)
    between = np.stack([np.interp(fine, nm, unit) for unit in np.eye(len(nm))])
    XYZ = fill_bands(reflectance).double().numpy() @ between @ weights
    white = colour.XYZ_to_xy(weights.sum(0))
    return torch.from_numpy(np.asarray(colour.XYZ_to_Lab(XYZ, white), dtype=np.float64))


def compute_typology_angles(
    reflectance: Float[Tensor, "people wavelength"],
) -> Float[Tensor, "people"]:
    """Compute the individual typology angle atan2(L* - 50, b*) in degrees, under D65."""
    lightness, _, b = compute_lab(reflectance).unbind(-1)
    return torch.rad2deg(torch.atan2(lightness - 50, b))


def compute_differences(
    recovered: Float[Tensor, "people wavelength"], target: Float[Tensor, "people wavelength"]
) -> Float[Tensor, "people light"]:
    """Compute CIEDE2000 between recovered and measured spectra under each of `LIGHTS`."""
    pairs = ((compute_lab(recovered, light), compute_lab(target, light)) for light in LIGHTS)
    differences = [colour.delta_E(a.numpy(), b.numpy(), method="CIE 2000") for a, b in pairs]
    return torch.from_numpy(np.stack(differences, -1))
