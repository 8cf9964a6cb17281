"""The 33 bands, and the measured cameras and the standard observer on them."""

from functools import cache

import torch
from jaxtyping import Float
from torch import Tensor

from skinnet.physics._tables import read_rows, read_table

WAVELENGTHS = torch.arange(400.0, 721.0, 10.0, dtype=torch.float64)
"""The 33 bands in nm (Alotaibi & Smith 2017, section 3.5)."""


@cache
def load_cameras() -> dict[str, Float[Tensor, "wavelength 3"]]:
    """Load the spectral sensitivities of the 52 measured cameras.

    Returns:
        By name, sensitivities [33, 3] of R, G and B, each of unit sum, float64.

    Source:
        Academy Software Foundation, rawtoaces-data (Apache-2.0).

    Example:
        >>> from skinnet.physics import load_cameras
        >>> cameras = load_cameras()
        >>> len(cameras), tuple(cameras["Nikon D200"].shape)
        (52, (33, 3))
    """
    _, *rows = read_rows("cameras")
    curves: dict[str, list[Tensor]] = {}
    for camera, _channel, *values in rows:
        channel = torch.tensor([float(value) for value in values], dtype=torch.float64)
        curves.setdefault(camera, []).append(channel)
    stacked = {name: torch.stack(rgb, -1) for name, rgb in curves.items()}
    return {name: curve / curve.sum(0) for name, curve in stacked.items()}


def load_observer() -> Float[Tensor, "wavelength 3"]:
    """Load the CIE 1931 2 degree colour matching functions.

    Returns:
        Functions [33, 3] of X, Y and Z, each of unit sum, float64.

    Source:
        CIE 015:2018.

    Example:
        >>> from skinnet.physics import WAVELENGTHS, load_observer
        >>> int(WAVELENGTHS[load_observer()[:, 1].argmax()])  # the eye is most sensitive to green
        560
    """
    curves = torch.stack(list(read_table("observer").values()), -1)
    return curves / curves.sum(0)
