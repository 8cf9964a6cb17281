"""Derivatives of chroma are those of the torch layer, and gloss dilutes them."""

import numpy as np
import pytest
import torch

from skinnet import Decomposer, SkinDecoder
from skinnet.inference._comparison import colour_derivatives as module
from skinnet.inference._comparison.colour_derivatives import (
    compute_chroma,
    differentiate_chroma,
    tabulate_daylight,
)
from skinnet.inference.full_resolution._colour_table import ColourTable

PIGMENTS = np.log([[0.02, 0.03], [0.05, 0.06], [0.2, 0.05]])


@pytest.fixture(scope="module")
def table() -> ColourTable:
    decomposer = Decomposer(threads=1)
    return tabulate_daylight(decomposer.encoder, decomposer.decoder)


def test_they_are_those_of_the_skin_layer(table: ColourTable) -> None:
    decoder = SkinDecoder(Decomposer(threads=1).encoder.optics, fast=False, dtype=torch.float64)

    def chroma(logs: torch.Tensor) -> torch.Tensor:
        colour = decoder(*logs.exp()[:, None, None]).reshape(3).log()
        return colour[::2] - colour[1]

    expected = [
        torch.autograd.functional.jacobian(chroma, torch.from_numpy(one)).numpy()
        for one in PIGMENTS
    ]
    found = differentiate_chroma(table, PIGMENTS, np.zeros(3)) / module._CONTRAST
    np.testing.assert_allclose(found, expected, atol=0.02)


def test_gloss_dilutes_them(table: ColourTable) -> None:
    bare, glossy = (differentiate_chroma(table, PIGMENTS, np.full(3, g)) for g in (0.0, 0.1))
    assert (np.abs(glossy[:, :, 0]) < np.abs(bare[:, :, 0])).all()


def test_chroma_is_free_of_brightness() -> None:
    colour = np.log([[0.5, 0.3, 0.2]])
    np.testing.assert_allclose(compute_chroma(colour), compute_chroma(colour + 1))
