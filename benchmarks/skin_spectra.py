"""Measured spectra of skin, 400 to 720 nm at 10 nm, float64; bands that were not measured are NaN.

Both sets were measured with a spectrophotometer: compare them with `include_specular`.
"""

from pathlib import Path

import torch
from jaxtyping import Float, Int
from torch import Tensor

_FOLDER = Path(__file__).parent / "data"
_BLOCKS, _SEED = 8, 0


def load_forearms() -> Float[Tensor, "people wavelength"]:
    """Load the reflectance of the inner forearm of 100 people (NIST, doi 10.18434/M38597)."""
    return torch.tensor([row[1:] for row in _read("nist_forearm_100")]).double().T


def load_issa() -> Float[Tensor, "record wavelength"]:
    """Load 348 spectra of faces and arms of many peoples (ISSA, Lu et al. 2025)."""
    return torch.tensor([row[2:] for row in _read("issa_train")]).double()


def halve_forearms() -> tuple[Int[Tensor, "half"], Int[Tensor, "half"]]:
    """Divide the 100 people at random, always in the same way."""
    rng = torch.Generator().manual_seed(_SEED)
    ours, theirs = torch.randperm(100, generator=rng).chunk(2)
    return ours, theirs


def halve_issa() -> tuple[Int[Tensor, "half"], Int[Tensor, "half"]]:
    """Divide the records by alternating blocks: neighbouring records are of the same person."""
    blocks = torch.arange(348).tensor_split(_BLOCKS)
    return torch.cat(blocks[::2]), torch.cat(blocks[1::2])


def fill_bands(spectra: Float[Tensor, "*batch wavelength"]) -> Float[Tensor, "*batch wavelength"]:
    """Give each missing band the value of the nearest measured band below it."""
    filled = spectra.clone()
    for band in range(1, filled.shape[-1]):
        missing = filled[..., band].isnan()
        filled[..., band] = torch.where(missing, filled[..., band - 1], filled[..., band])
    return filled


def _read(name: str) -> list[list[float]]:
    lines = (_FOLDER / f"{name}.csv").read_text(encoding="utf-8").splitlines()[2:]
    return [[_to_number(cell) for cell in line.split(",")] for line in lines]


def _to_number(cell: str) -> float:
    try:
        return float(cell)
    except ValueError:  # a label, or nothing
        return float("nan")
