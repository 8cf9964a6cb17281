"""Wavelength grid and the measured tables on it: pigments, lights, observer, cameras."""

import csv
from functools import cache
from importlib.resources import files

import numpy as np
import torch
from jaxtyping import Float
from torch import Tensor

WAVELENGTHS = torch.arange(400.0, 721.0, 10.0, dtype=torch.float64)
"""The 33 bands in nm (Alotaibi & Smith 2017, section 3.5)."""

BANDS = len(WAVELENGTHS)


@cache
def table(name: str) -> dict[str, Float[Tensor, "wavelength"]]:
    """Columns of `skinnet/tables/NAME.csv` by their heading, float64 [33].

    Units and source stand in the file's first line.
    """
    head, *rows = _rows(name)
    values = torch.tensor(np.array(rows, dtype=float))
    return dict(zip(head[1:], values.T[1:], strict=True))


@cache
def cameras() -> dict[str, Float[Tensor, "wavelength 3"]]:
    """Spectral sensitivities of 52 cameras by name, R, G, B, each channel of unit sum, [33, 3]."""
    _, *rows = _rows("cameras")
    curves: dict[str, list[Tensor]] = {}
    for camera, _channel, *values in rows:
        channel = torch.tensor([float(value) for value in values], dtype=torch.float64)
        curves.setdefault(camera, []).append(channel)
    stacked = {name: torch.stack(rgb, -1) for name, rgb in curves.items()}
    return {name: curve / curve.sum(0) for name, curve in stacked.items()}


def observer() -> Float[Tensor, "wavelength 3"]:
    """CIE 1931 2 degree colour matching functions, each of unit sum, [33, 3]."""
    curves = torch.stack(list(table("observer").values()), -1)
    return curves / curves.sum(0)


def _rows(name: str) -> list[list[str]]:
    text = (files("skinnet.physics") / "tables" / f"{name}.csv").read_text(encoding="utf-8")
    return list(csv.reader(line for line in text.splitlines() if not line.startswith("#")))
