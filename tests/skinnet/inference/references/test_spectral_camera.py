"""The camera in NumPy is that of physics, and its colours are those of colour-science."""

import colour
import numpy as np
import pytest
import torch

from skinnet.inference._references.spectral_camera import (
    BANDS,
    list_lights,
    make_daylight_observer,
    make_light,
    make_matrix,
    make_sensitivity,
)
from skinnet.physics import LIGHTS, WAVELENGTHS, Capture, SpectralCamera


def test_names_and_bands_are_those_of_physics() -> None:
    assert list_lights() == LIGHTS
    assert BANDS.tolist() == WAVELENGTHS.tolist()


@pytest.mark.parametrize("name", LIGHTS)
@pytest.mark.parametrize("kelvin", [4200.0, 7000.0, 11000.0])
def test_the_matrix_is_that_of_physics(name: str, kelvin: float) -> None:
    rng = np.random.default_rng(len(name))
    camera = SpectralCamera(dtype=torch.float64)
    coefficients, balance = rng.normal(0, 1, 6), rng.normal(0, 0.2, 2)
    light = torch.zeros(len(LIGHTS), dtype=torch.float64)
    light[LIGHTS.index(name)] = 1
    temperature = torch.tensor(kelvin, dtype=torch.float64)
    capture = Capture(light, temperature, torch.tensor(coefficients), torch.tensor(balance))
    found = make_matrix(
        make_light(name, kelvin), make_sensitivity(coefficients), (balance[0], balance[1])
    )
    np.testing.assert_allclose(found, camera.matrix(capture).numpy(), atol=2e-7)


def test_colours_under_daylight_are_those_of_colour_science() -> None:
    spectra = list(colour.SDS_COLOURCHECKERS["BabelColor Average"].values())[:18]
    bands = np.array([np.interp(BANDS, one.wavelengths, one.values) for one in spectra])
    shape = colour.SpectralShape(360, 780, 5)
    light = colour.SDS_ILLUMINANTS["D65"].copy().align(shape)
    observer = colour.MSDS_CMFS["CIE 1931 2 Degree Standard Observer"].copy().align(shape)
    xyz = [
        colour.sd_to_XYZ(one.copy().align(shape), observer, light, method="Integration") / 100
        for one in spectra
    ]
    expected = colour.XYZ_to_RGB(np.array(xyz), "sRGB")
    lab = [
        colour.XYZ_to_Lab(colour.RGB_to_XYZ(each, "sRGB"))
        for each in (bands @ make_daylight_observer(), expected)
    ]
    assert colour.delta_E(*lab).max() < 0.5
