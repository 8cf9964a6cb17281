"""Light, camera and colour: two references that are not ours, and white that stays white."""

import warnings
from collections.abc import Callable
from operator import itemgetter

import numpy as np
import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st

with warnings.catch_warnings():
    # colour-science says at import which of its optional parts are absent.
    warnings.simplefilter("ignore")
    import colour

from skinnet.physics.camera import LIGHTS, SpectralCamera, spectrum_to_srgb
from skinnet.physics.capture import Capture
from skinnet.physics.spectra import load_cameras, load_observer
from tests import oracle

SHAPE = colour.SpectralShape(400, 720, 10)
ILLUMINANTS = oracle.columns("illuminants")
SPDS = {name: power / power.sum() for name, power in ILLUMINANTS.items()} | {
    f"D{kelvin}": oracle.daylight(kelvin) for kelvin in (4000, 5000, 6504, 9000, 25000)
}


def spectra(count: int = 20) -> np.ndarray:
    """Skin, a colour checker, and smooth random reflectance."""
    patches = colour.SDS_COLOURCHECKERS["BabelColor Average"].values()
    checker = np.stack([patch[oracle.WAVELENGTHS] for patch in patches])
    skin = oracle.reflectance("measured", np.linspace(0, 1, count), np.linspace(0, 0.3, count))
    waves = np.random.default_rng(0).normal(size=(count, 6))
    phase = np.linspace(0, 1, 33)[:, None] * np.arange(6) * np.pi
    return np.concatenate([checker, skin, 1 / (1 + np.exp(-waves @ np.cos(phase).T))])


def tensors(*arrays: np.ndarray) -> list[torch.Tensor]:
    return [torch.tensor(array, dtype=torch.float64) for array in arrays]


def colour_srgb(spectrum: np.ndarray, light: np.ndarray) -> np.ndarray:
    """colour-science's linear sRGB of a spectrum, its white scaled in XYZ to D65.

    With the matrix derived from the primaries: the one rounded to four digits, its default, sends
    white to 1.00014 and so does not keep neutrals neutral.
    """
    cmfs = colour.MSDS_CMFS["CIE 1931 2 Degree Standard Observer"].copy().align(SHAPE)
    power = colour.SpectralDistribution(light, SHAPE.wavelengths)
    xyz, white = (
        colour.sd_to_XYZ(
            colour.SpectralDistribution(values, SHAPE.wavelengths),
            cmfs,
            power,
            method="Integration",
        )
        for values in (spectrum, np.ones(33))
    )
    d65 = colour.xy_to_XYZ([0.3127, 0.3290])
    space = colour.RGB_COLOURSPACES["sRGB"].copy()
    space.use_derived_transformation_matrices(True)
    return colour.XYZ_to_RGB(xyz / white * d65, space, chromatic_adaptation_transform=None)


@pytest.mark.parametrize("name", SPDS)
def test_the_observer_as_camera_agrees_with_colour_science(name: str) -> None:
    light, reflectance = tensors(SPDS[name], spectra())
    actual = reflectance @ spectrum_to_srgb(light, load_observer(), load_observer())
    expected = np.stack([colour_srgb(spectrum, SPDS[name]) for spectrum in spectra()])
    assert actual.numpy() == pytest.approx(expected, abs=1e-4)


@pytest.mark.parametrize("name", ["D5000", "D6504", "A", "FL11", "LED-V1"])
def test_spectral_camera_of_the_observer_agrees_with_colour_science(name: str) -> None:
    camera = SpectralCamera(mean=load_observer(), dtype=torch.float64)
    capture = camera.standard()
    if name[1:].isdigit():
        capture = capture._replace(temperature=torch.tensor(float(name[1:]), dtype=torch.float64))
    else:
        capture = capture._replace(light=torch.eye(len(LIGHTS)).double()[LIGHTS.index(name)])
    expected = np.stack([colour_srgb(spectrum, SPDS[name]) for spectrum in spectra()])
    assert camera(*tensors(spectra()), capture).numpy() == pytest.approx(expected, abs=1e-4)


@pytest.mark.parametrize("light", SPDS.values(), ids=SPDS)
def test_measured_cameras_agree_with_the_oracle(light: np.ndarray) -> None:
    for name, sensitivity in oracle.measured_cameras().items():
        ours = spectrum_to_srgb(*tensors(light), load_cameras()[name], load_observer())
        expected = oracle.linear_srgb(spectra(), light, sensitivity)
        assert (tensors(spectra())[0] @ ours).numpy() == pytest.approx(expected, abs=1e-6)


def test_mixtures_agree_with_the_oracle(random_capture: Callable[..., Capture]) -> None:
    capture, camera = random_capture(5), SpectralCamera(dtype=torch.float64)
    perfect = capture._replace(white_balance=torch.zeros(5, 2, dtype=torch.float64))
    actual = camera(torch.stack(tensors(spectra()) * 5), perfect)
    for i in range(5):
        lamps = np.stack([oracle.daylight(float(capture.temperature[i])), *list(SPDS.values())[:8]])
        sensitivity = camera.sensitivity(capture.camera[i]).numpy()
        expected = oracle.linear_srgb(spectra(), capture.light[i].numpy() @ lamps, sensitivity)
        assert actual[i].numpy() == pytest.approx(expected, abs=1e-6)


def test_light_and_sensitivity_have_unit_sum(random_capture: Callable[..., Capture]) -> None:
    capture, camera = random_capture(7, dtype=torch.float32), SpectralCamera()
    assert camera.mix_lights(capture.light, capture.temperature).sum(-1) == pytest.approx(
        1, abs=1e-6
    )
    assert camera.sensitivity(capture.camera).sum(-2) == pytest.approx(1, abs=2e-6)


@given(st.integers(0, 10**6), st.floats(0, 3), st.sampled_from([3, 6, 51]))
def test_white_is_neutral_for_any_light_and_camera(
    random_capture: Callable[..., Capture], seed: int, spread: float, count: int
) -> None:
    camera = SpectralCamera(components=count)
    capture = random_capture(8, seed=seed, dtype=torch.float32, components=count)
    capture = capture._replace(camera=spread * capture.camera, white_balance=torch.zeros(8, 2))
    assert camera(torch.ones(8, 33), capture) == pytest.approx(1, abs=1e-6)
    assert camera.white(capture) == pytest.approx(1, abs=1e-6)


@pytest.mark.parametrize("light", SPDS.values(), ids=SPDS)
def test_white_is_neutral_for_every_measured_camera(light: np.ndarray) -> None:
    sensitivity = torch.stack(list(load_cameras().values())).float()
    matrix = spectrum_to_srgb(torch.tensor(light).float(), sensitivity, load_observer().float())
    assert sensitivity.shape == (52, 33, 3)
    assert torch.ones(33) @ matrix == pytest.approx(1, abs=1e-6)


def test_white_balance_multiplies_red_and_blue_of_the_camera() -> None:
    camera = SpectralCamera(dtype=torch.float64)
    standard = camera.standard()
    warm = standard._replace(white_balance=torch.tensor([0.1, -0.2], dtype=torch.float64))
    raw_white = camera.mix_lights(standard.light, standard.temperature) @ camera.mean
    (channels,) = tensors(oracle.camera_to_xyz((camera.mean / raw_white).numpy()))
    to_srgb = torch.linalg.inv(*tensors(oracle.srgb_to_xyz())) @ channels
    gain = torch.tensor([0.1, 0.0, -0.2], dtype=torch.float64).exp()
    assert camera.white(standard).numpy() == pytest.approx(1, abs=1e-12)
    assert camera.white(warm).numpy() == pytest.approx((to_srgb @ gain).numpy(), abs=1e-9)


@pytest.mark.parametrize("kelvin", [4000.0, 5500.0, 6990.0, 7010.0, 25000.0])
def test_capture_has_the_right_gradients(
    kelvin: float, random_capture: Callable[..., Capture]
) -> None:
    camera, (light, _, coefficients, balance) = (
        SpectralCamera(dtype=torch.float64),
        random_capture(2)[:4],
    )
    inputs = [value.requires_grad_() for value in (light, coefficients, balance)]
    heat = torch.full((2,), kelvin / 1000, dtype=torch.float64, requires_grad=True)
    assert torch.autograd.gradcheck(
        lambda light, heat, c, wb: camera.matrix(Capture(light, 1000 * heat, c, wb)),
        (inputs[0], heat, *inputs[1:]),
    )


@pytest.mark.parametrize("name", ["mean", "basis", "lights"])
def test_tables_are_trainable(name: str, random_capture: Callable[..., Capture]) -> None:
    start = getattr(SpectralCamera(dtype=torch.float64), name).clone()
    camera = SpectralCamera(**{name: torch.nn.Parameter(start)}, dtype=torch.float64)
    assert [key for key, _ in camera.named_parameters()] == [name]
    camera.matrix(random_capture(3)).square().sum().backward()
    gradient = getattr(camera, name).grad
    assert torch.isfinite(gradient).all() and gradient.abs().max() > 0


def test_components_explain_the_stated_share_of_variance() -> None:
    camera = SpectralCamera(components=51, dtype=torch.float64)
    assert camera.explained.sum() == pytest.approx(1, abs=1e-9)
    assert (camera.explained.diff() <= 0).all()
    assert camera.explained[:6].sum() == pytest.approx(0.92, abs=0.005)
    curves = torch.stack(list(load_cameras().values())).flatten(1)
    basis = camera.basis.flatten(1)
    coefficients = torch.linalg.lstsq(basis.T, (curves - camera.mean.flatten()).T).solution
    assert coefficients.std(dim=1) == pytest.approx(1, abs=1e-6)
    assert (basis.T @ coefficients).T + camera.mean.flatten() == pytest.approx(curves, abs=1e-6)


def test_batch_and_dtype_do_not_matter(random_capture: Callable[..., Capture]) -> None:
    capture, camera = random_capture(2, 3), SpectralCamera(dtype=torch.float64)
    matrix = camera.matrix(capture)
    for i, j in np.ndindex(2, 3):
        one = camera.matrix(capture.map(itemgetter((i, j))))
        assert torch.allclose(matrix[i, j], one, atol=1e-12)
    single = SpectralCamera().matrix(capture.map(torch.Tensor.float))
    assert single.dtype == torch.float32 and torch.allclose(single.double(), matrix, atol=1e-5)


def test_state_dict_round_trip() -> None:
    saved, loaded = SpectralCamera(mean=load_cameras()["Nikon D200"]), SpectralCamera()
    loaded.load_state_dict(saved.state_dict())
    assert torch.equal(loaded.matrix(loaded.standard()), saved.matrix(saved.standard()))
