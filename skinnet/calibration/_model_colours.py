"""Colours of the skin model over its two pigments, for a calibration."""

import numpy as np
import torch
from jaxtyping import Float

from skinnet.physics.reflectance import SkinReflectance

_SIDE = 64

_Range = tuple[float, float]


def tabulate_model_colours(
    matrix: Float[np.ndarray, "wavelength 3"], optics: str, f_mel: _Range, f_blood: _Range
) -> Float[np.ndarray, "mel blood 3"]:
    """Tabulate a few thousand colours of the model over the ranges of the fractions."""
    axes = [
        torch.linspace(low**0.5, high**0.5, _SIDE, dtype=torch.float64) ** 2
        for low, high in (f_mel, f_blood)
    ]
    mel, blood = (axis.ravel() for axis in torch.meshgrid(*axes, indexing="ij"))
    colours = SkinReflectance(optics, dtype=torch.float64)(mel, blood).numpy() @ matrix
    return np.asarray(colours.reshape(_SIDE, _SIDE, 3))
