"""From sensor values to linear sRGB, compared with training's camera and with colour-science."""

import warnings

import numpy as np
import oracle
import pytest
import torch

with warnings.catch_warnings():
    # colour-science says at import which of its optional parts are absent.
    warnings.simplefilter("ignore")
    import colour

from skinnet.images._raw import colours
from skinnet.images._raw.cameras import read_cameras
from skinnet.images._raw.colours import StatedMatrix, adapt_matrix, choose_matrix
from skinnet.physics import load_cameras, load_light, load_observer, spectrum_to_srgb
from tools import bake_cameras

SPECTRA = oracle.reflectance("measured", np.linspace(0.02, 0.4, 12), np.linspace(0.02, 0.1, 12))
GAINS = np.array([0.5, 1.0, 0.7])
IDENTITY = StatedMatrix(np.eye(3), np.ones(3))


@pytest.mark.parametrize("light", ["D65", "D5000K", "A", "FL11", "LED-B3"])
def test_measured_cameras_give_the_colours_of_training(light: str) -> None:
    power = load_light(light)
    for camera in read_cameras():
        curves = load_cameras()[camera.name]
        sensor = curves.numpy() * GAINS
        white, daylight = power.numpy() @ sensor, load_light("D65").numpy() @ sensor
        balance = white[1] / white
        values = (SPECTRA * power.numpy()) @ sensor * balance / white[1]
        actual = values @ adapt_matrix(camera.matrix, daylight, balance.tolist()).T
        expected = torch.from_numpy(SPECTRA) @ spectrum_to_srgb(power, curves, load_observer())
        # The table has four digits.
        np.testing.assert_allclose(actual, expected.numpy(), atol=3e-4)


def test_white_is_adapted_as_colour_science_scales_xyz() -> None:
    """The observer as sensor, whose values are XYZ, under the light A."""
    illuminant = colour.CCS_ILLUMINANTS["CIE 1931 2 Degree Standard Observer"]["A"]
    white = colour.xy_to_XYZ(illuminant)
    matrix = adapt_matrix(colours.XYZ_TO_SRGB * colours.D65, colours.D65, (1 / white).tolist())
    patch = np.array([0.3, 0.2, 0.05])
    expected = colours.XYZ_TO_SRGB @ colour.chromatic_adaptation(
        patch, white, colours.D65, method="Von Kries", transform="XYZ Scaling"
    )
    np.testing.assert_allclose(matrix @ (patch / white), expected, atol=1e-6)


def test_the_matrix_of_srgb_is_that_of_its_primaries() -> None:
    np.testing.assert_allclose(colours.XYZ_TO_SRGB, np.linalg.inv(oracle.srgb_to_xyz()), atol=1e-6)
    np.testing.assert_allclose(colours.D65, oracle.D65, atol=1e-6)


def test_the_mean_of_stated_matrices_is_what_its_script_prints() -> None:
    rawpy = pytest.importorskip("rawpy")
    known = 0.002 if rawpy.libraw_version >= (0, 22) else 0.05  # earlier ones know fewer cameras
    np.testing.assert_allclose(colours._MEAN_STATED, bake_cameras.average_stated(), atol=known)


def measure_errors(trust: float, light: str) -> np.ndarray:
    """Errors of R/G of skin of each camera, from its stated matrix and the other cameras."""
    power, daylight = load_light(light).numpy(), load_light("D65").numpy()
    stated, errors = bake_cameras.read_stated(), []
    for name, own in stated.items():
        others = [camera for camera in read_cameras() if camera.name in stated.keys() - {name}]
        usual = np.mean([camera.matrix for camera in others], 0)
        mean = np.mean([stated[camera.name] for camera in others], 0)
        sensor = load_cameras()[name].numpy()
        balance = (power @ sensor)[1] / (power @ sensor)
        values = (SPECTRA * power) @ sensor * balance
        truth, found = (
            values @ adapt_matrix(matrix, daylight @ sensor, balance.tolist()).T
            for matrix in (bake_cameras.make_matrix(sensor), usual + trust * (own - mean))
        )
        ratio = found[:, 0] / found[:, 1] / (truth[:, 0] / truth[:, 1])
        errors.append(np.sqrt(((ratio - 1) ** 2).mean()))
    return np.array(errors)


@pytest.mark.parametrize("light", ["D65", "A", "LED-B3"])
def test_a_stated_matrix_is_worth_a_part_of_its_difference(light: str) -> None:
    pytest.importorskip("rawpy")
    errors, without, as_stated = (
        np.percentile(measure_errors(trust, light), (50, 90))
        for trust in (colours._TRUST, 0.0, 1.0)
    )
    assert errors[0] < 0.06 and errors[1] < 0.13
    assert errors[1] < without[1] and (errors < 0.75 * as_stated).all()


def test_other_cameras_are_near_the_usual_one() -> None:
    usual = np.mean([camera.matrix for camera in read_cameras()], 0)
    chosen = choose_matrix(None, StatedMatrix(colours._MEAN_STATED, np.ones(3)))
    np.testing.assert_allclose(chosen, usual)
    other = choose_matrix(None, IDENTITY)
    assert other is not None and np.abs(other - usual).max() < 0.3
    np.testing.assert_allclose(other.sum(1), 1, atol=1e-3)
    assert choose_matrix(None, None) is None
    assert choose_matrix(read_cameras()[3], IDENTITY) is read_cameras()[3].matrix


def test_a_balance_of_no_light_changes_nothing() -> None:
    matrix = read_cameras()[0].matrix
    assert adapt_matrix(matrix, np.ones(3), [1.0, 1.0, 1e-3]) is matrix
