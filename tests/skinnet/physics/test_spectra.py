"""The observer is colour-science's, and the cameras are complete."""

import warnings

import pytest
import torch

with warnings.catch_warnings():
    # colour-science says at import which of its optional parts are absent.
    warnings.simplefilter("ignore")
    import colour

from skinnet.physics.spectra import WAVELENGTHS, load_cameras, load_observer
from tests import oracle


def test_wavelengths_are_the_papers() -> None:
    assert WAVELENGTHS.tolist() == list(range(400, 721, 10))


def test_the_observer_agrees_with_colour_science() -> None:
    curves = colour.MSDS_CMFS["CIE 1931 2 Degree Standard Observer"][oracle.WAVELENGTHS]
    assert load_observer().numpy() == pytest.approx(curves / curves.sum(0), abs=1e-9)


def test_cameras_are_52_of_unit_sum() -> None:
    cameras = load_cameras()
    assert len(cameras) == 52 and "Nikon D200" in cameras
    curves = torch.stack(list(cameras.values()))
    assert (curves >= 0).all() and torch.allclose(curves.sum(1), torch.ones(52, 3).double())
