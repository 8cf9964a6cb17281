"""The comparison with peers: BioSkin's place is taken by a checkout of the same shape."""

from pathlib import Path

import pytest
import torch

from benchmarks import peers
from benchmarks.peers import PUBLISHED, recover_with_bioskin, score_peers
from skinnet.errors import InputError
from skinnet.physics import WAVELENGTHS, load_light, load_observer, spectrum_to_srgb

# Spectra are a + b x + c x^2 with x linear in wavelength, and its colours are those of D65 with red
# doubled: what is recovered is known.
CODE = """
from types import SimpleNamespace
import torch
{imports}

class BioSkinInference:
    def __init__(self, path, device):
        print("Loading", path)
        assert device == torch.device("cpu")
        self.model_params = SimpleNamespace(wavelength_begin=380, spectral_resolution=2)
        self.visible_range_limit, self.latent_size = 200, 3
        self.colours = torch.load({matrix!r})

    def _render(self, properties):
        x = (torch.arange(380, 780, 2) - 560) / 200
        return properties.double() @ torch.stack([x**0, x, x**2]).double()

    def skin_props_to_reflectance(self, properties):
        spectra = self._render(properties)
        return spectra.float(), spectra[:, 10:171:5] @ self.colours, 0, 0

    def reconstruct(self, bgr):
        _, colours, *_ = self.skin_props_to_reflectance(torch.eye(3))
        properties = bgr.double() @ torch.linalg.inv(colours)
        return properties, *self.skin_props_to_reflectance(properties)
"""


def make_checkout(path: Path, imports: str = "") -> Path:
    (path / "bioskin").mkdir()
    (path / "pretrained_models").mkdir()
    for name in peers.NETWORKS.values():
        for kind in ("json", "pt"):
            (path / "pretrained_models" / f"{name}.{kind}").touch()
    d65 = make_d65_matrix() * torch.tensor([2.0, 1.0, 1.0])
    torch.save(d65.flip(-1), path / "matrix.pt")
    code = CODE.format(imports=imports, matrix=str(path / "matrix.pt"))
    (path / "bioskin" / "bioskin.py").write_text(code)
    return path


def make_d65_matrix() -> torch.Tensor:
    return spectrum_to_srgb(load_light("D6504K"), load_observer(), load_observer()).double()


def make_spectra() -> torch.Tensor:
    x = (WAVELENGTHS.double() - 560) / 200
    factors = torch.tensor([[0.3, 0.1, 0.05], [0.2, 0.1, 0.0], [0.05, 0.02, 0.02]]).double()
    return factors @ torch.stack([x**0, x, x**2])


def test_without_a_checkout_published_figures_are_marked() -> None:
    found = score_peers(None, torch.zeros(3, 3), torch.zeros(3, 33))
    assert found == PUBLISHED and all(peer["published"] is True for peer in found.values())
    assert found["bioskin"]["median"] == 0.0153 and found["bioskin"]["p95"] == 0.0337
    assert found["six_parameters"]["ciede2000"] == {"A": 0.36, "FL11": 0.66, "LED-B3": 0.28}


def test_a_checkout_is_run_in_its_own_colours(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    target = make_spectra()
    rgb = target @ make_d65_matrix()
    recovered = recover_with_bioskin(make_checkout(tmp_path), rgb)
    assert torch.allclose(recovered, target, atol=1e-4)
    assert capsys.readouterr().out == ""


def test_measured_figures_take_the_place_of_published_ones(tmp_path: Path) -> None:
    target = make_spectra()
    shifted = target + 0.01
    shifted[0, -1] = torch.nan
    found = score_peers(make_checkout(tmp_path), target @ make_d65_matrix(), shifted)
    assert set(found) == {"bioskin", "bioskin_occlusion", "six_parameters"}
    for name in peers.NETWORKS:
        assert found[name] == {
            "median": pytest.approx(0.01, abs=1e-4),
            "p95": pytest.approx(0.01, abs=1e-4),
            "published": False,
        }
    assert found["six_parameters"]["published"] is True
    assert PUBLISHED["bioskin"]["published"] is True


def test_another_directory_is_refused_with_what_it_lacks(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"lacks bioskin/bioskin\.py, .*facebookresearch/BioSkin"):
        recover_with_bioskin(tmp_path, torch.zeros(1, 3))
    (make_checkout(tmp_path) / "pretrained_models" / "BioSkinAO.pt").unlink()
    with pytest.raises(InputError, match=r"lacks pretrained_models/BioSkinAO\.pt: "):
        score_peers(tmp_path, torch.full((2, 3), 0.2), torch.full((2, 33), 0.2))


def test_a_package_that_the_checkout_needs_is_named(tmp_path: Path) -> None:
    make_checkout(tmp_path, imports="import absent_package")
    with pytest.raises(InputError, match="absent_package"):
        recover_with_bioskin(tmp_path, torch.zeros(1, 3))
