"""Lights and cameras by name or from a file."""

from pathlib import Path

import colour
import numpy as np
import pytest
import torch

from skinnet.errors import InputError
from skinnet.physics.camera import SpectralCamera
from skinnet.physics.sources import load_camera, load_light, load_spectrum_to_srgb
from skinnet.physics.spectra import WAVELENGTHS, load_cameras


@pytest.mark.parametrize("name", ["D65", "D50", "d55"])
def test_daylight_is_cies(name: str) -> None:
    exact = colour.SDS_ILLUMINANTS[name.upper()].copy().align(colour.SpectralShape(400, 720, 10))
    values = exact.values / exact.values.sum()
    np.testing.assert_allclose(load_light(name).numpy(), values, rtol=2e-3)


def test_every_light_has_unit_sum() -> None:
    for name in ("A", "LED-B3", "led-b3", "D5500K", "D10000"):
        assert load_light(name).shape == (33,)
        assert load_light(name).sum().item() == pytest.approx(1)


def test_the_papers_camera_is_found_in_any_case() -> None:
    assert torch.equal(load_camera("nikon d200"), load_cameras()["Nikon D200"])


def test_the_standard_matrix_is_the_spectral_cameras() -> None:
    ours = SpectralCamera(dtype=torch.float64)
    exact = ours.matrix(ours.standard())
    torch.testing.assert_close(load_spectrum_to_srgb("D6504K", "mean"), exact, rtol=1e-6, atol=1e-9)


def test_white_stays_white() -> None:
    for light_name in ("A", "LED-B1", "D40"):
        white = load_spectrum_to_srgb(light_name, "Nikon D200").sum(0)
        torch.testing.assert_close(white, torch.ones(3, dtype=torch.float64))


def test_spectra_from_files_are_interpolated(tmp_path: Path) -> None:
    rows = [f"{w},{w / 1000}" for w in range(380, 741, 20)]
    (tmp_path / "led.csv").write_text("# made up\nnm,power\n" + "\n".join(rows))
    exact = WAVELENGTHS / WAVELENGTHS.sum()
    torch.testing.assert_close(load_light(str(tmp_path / "led.csv")), exact)
    three = [f"{w},{w},{2 * w},1" for w in range(720, 399, -40)]
    (tmp_path / "cam.csv").write_text("\n".join(three))
    found = load_camera(str(tmp_path / "cam.csv"))
    torch.testing.assert_close(found[:, 0], found[:, 1])
    torch.testing.assert_close(found[:, 2], torch.full((33,), 1 / 33, dtype=torch.float64))


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("450,1\n700,1", "covers 450 to 700 nm"),
        ("400,1\n720,x", "not 2 numbers"),
        ("400,1,2\n720,1,2", "needs 2 columns"),
        ("400,-1\n720,1", "negative or not finite"),
        ("400,nan\n720,1", "negative or not finite"),
        ("400,0\n720,0", "is zero"),
        ("400,1\n400,2\n720,1", "a wavelength twice"),
        ("", "needs 2 columns"),
    ],
)
def test_a_bad_spectrum_is_named(tmp_path: Path, text: str, words: str) -> None:
    path = tmp_path / "bad.csv"
    path.write_text(text)
    with pytest.raises(InputError, match=f"bad.csv.*{words}"):
        load_light(str(path))


def test_an_unknown_name_lists_the_closest_names(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"no camera 'Nikon D201'.*Nikon D200"):
        load_camera("Nikon D201")
    with pytest.raises(InputError, match=r"no light 'LED-B9'.*LED-B"):
        load_light("LED-B9")
    with pytest.raises(InputError, match="Daylight has 4000 to 25000 K"):
        load_light("D30")
    with pytest.raises(InputError, match=r"absent.csv cannot be read"):
        load_light(str(tmp_path / "absent.csv"))
