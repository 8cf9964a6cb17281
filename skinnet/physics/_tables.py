"""Measured tables on the 33 bands, as the wheel carries them."""

import csv
from functools import cache
from importlib.resources import files

import numpy as np
import torch
from jaxtyping import Float
from torch import Tensor


@cache
def read_table(name: str) -> dict[str, Float[Tensor, "wavelength"]]:
    """Read the columns of `skinnet/physics/tables/NAME.csv` by their heading, float64 [33].

    The file's first line gives units and source.
    """
    head, *rows = read_rows(name)
    values = torch.tensor(np.array(rows, dtype=float))
    return dict(zip(head[1:], values.T[1:], strict=True))


def read_rows(name: str) -> list[list[str]]:
    """Read the rows of a table, the heading first."""
    text = (files("skinnet.physics") / "tables" / f"{name}.csv").read_text(encoding="utf-8")
    return list(csv.reader(line for line in text.splitlines() if not line.startswith("#")))
