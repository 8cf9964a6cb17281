"""The 33 bands, and the measured cameras and the standard observer on them."""

from functools import cache

import torch
from jaxtyping import Float
from torch import Tensor

from skinnet.physics._tables import read_rows, read_table

WAVELENGTHS = torch.arange(400.0, 721.0, 10.0, dtype=torch.float64)
"""The 33 bands in nm (Alotaibi & Smith 2017, section 3.5)."""

BANDS = len(WAVELENGTHS)


@cache
def load_cameras() -> dict[str, Float[Tensor, "wavelength 3"]]:
    """Spectral sensitivities of 52 cameras by name, R, G, B, each channel of unit sum, [33, 3]."""
    _, *rows = read_rows("cameras")
    curves: dict[str, list[Tensor]] = {}
    for camera, _channel, *values in rows:
        channel = torch.tensor([float(value) for value in values], dtype=torch.float64)
        curves.setdefault(camera, []).append(channel)
    stacked = {name: torch.stack(rgb, -1) for name, rgb in curves.items()}
    return {name: curve / curve.sum(0) for name, curve in stacked.items()}


def load_observer() -> Float[Tensor, "wavelength 3"]:
    """CIE 1931 2 degree colour matching functions, each of unit sum, [33, 3]."""
    curves = torch.stack(list(read_table("observer").values()), -1)
    return curves / curves.sum(0)
