"""Mitsuba's spectral integral of skin, light and camera against our sum over 33 bands."""

import re
import sys

import numpy as np
import pytest
import torch

from skinnet.errors import InputError
from skinnet.material import MitsubaCapture
from skinnet.physics import SkinReflectance, load_spectrum_to_srgb
from skinnet.physics.spectra import WAVELENGTHS

mi = pytest.importorskip("mitsuba", reason="Mitsuba 3 is not installed: pip install mitsuba")

CAMERA = "Nikon D200"
F_MEL = np.array([0.012, 0.03, 0.08, 0.2, 0.4])
"""From the palest to the darkest skin, and beyond."""
F_BLOOD = np.array([0.02, 0.045, 0.07])
"""The range of Table 3 of the paper."""


@pytest.fixture(autouse=True, scope="module")
def spectral():
    mi.set_variant("scalar_spectral")


def render(capture, reflectance, height=1, width=1, spp=1024):
    """Render a flat patch that fills the picture, in even light from all around."""
    scene = {
        "type": "scene",
        "integrator": {"type": "direct", "emitter_samples": 0, "bsdf_samples": 1},
        "sensor": {
            "type": "orthographic",
            "to_world": mi.ScalarTransform4f().look_at([0, 0, 5], [0, 0, 0], [0, 1, 0]),
            "film": capture.film(height, width),
            "sampler": {"type": "stratified", "sample_count": spp},
        },
        "light": {"type": "constant", "radiance": capture.light()},
        "patch": {
            "type": "rectangle",
            "to_world": mi.ScalarTransform4f().scale([1, height / width, 1]),
            "bsdf": {"type": "diffuse", "reflectance": reflectance},
        },
    }
    return capture.develop(mi.render(mi.load_dict(scene)))


def unfiltered(skin):
    for name in {"melanin", "hemoglobin", "offset"} & {*skin}:
        skin[name]["filter_type"] = "nearest"
    return skin


@pytest.mark.parametrize("light", ["D65", "A", "FL11", "LED-B3"])
def test_a_flat_patch_of_skin_has_the_colour_of_spectral_camera(light: str) -> None:
    capture = MitsubaCapture(light, CAMERA)
    f_mel, f_blood = np.meshgrid(F_MEL, F_BLOOD, indexing="ij")
    # Row 0 of a texture is at the bottom of Mitsuba's rectangle.
    skin = render(capture, unfiltered(capture.skin(f_mel[::-1], f_blood[::-1])), *f_mel.shape)
    # The same numbers at random: what is left of the noise is that of a perfect diffuser.
    white = render(capture, {"type": "uniform", "value": 1.0}, *f_mel.shape)
    spectra = SkinReflectance(dtype=torch.float64)(*map(torch.from_numpy, (f_mel, f_blood)))
    expected = (spectra @ load_spectrum_to_srgb(light, CAMERA)).numpy()
    found = skin / white
    error = np.linalg.norm(found - expected, axis=-1) / np.linalg.norm(expected, axis=-1)
    assert white == pytest.approx(np.ones_like(white), abs=0.02)
    assert error.max() < 0.005


def test_the_spectrum_is_that_of_the_layer_at_every_band() -> None:
    f_mel, f_blood = (torch.tensor(each, dtype=torch.float64) for each in (0.07, 0.033))
    texture = mi.load_dict(MitsubaCapture().skin(f_mel.item(), f_blood.item()))
    interaction = mi.SurfaceInteraction3f()
    expected = SkinReflectance(dtype=torch.float64)(f_mel, f_blood).numpy()
    found = []
    for four in np.resize(WAVELENGTHS.numpy(), (9, 4)):
        interaction.wavelengths = mi.Spectrum(*four)
        found += [*texture.eval(interaction)]
    assert found[:33] == pytest.approx(expected, abs=1e-3)
    assert 0 < texture.mean() < 1


def test_an_offset_comes_back_under_its_own_light_and_camera() -> None:
    """A lip and a grey: colours that skin does not have."""
    light, camera = "D65", "Nikon D200"
    matrix = load_spectrum_to_srgb(light, camera).numpy()
    capture = MitsubaCapture(light, camera)
    colour = np.array([[[0.45, 0.12, 0.14], [0.3, 0.3, 0.3]]])
    skin = (SkinReflectance(dtype=torch.float64)(0.05, 0.04).numpy()) @ matrix
    maps = capture.skin(np.full((1, 2), 0.05), np.full((1, 2), 0.04), colour - skin, matrix)
    found = render(capture, unfiltered(maps), 1, 2)
    assert found == pytest.approx(colour, abs=0.01)


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        ((np.full((2, 2), 3.0), 0.04), "melanin is a volume fraction in [0, 1]; got 3."),
        ((0.04, np.full((2, 2), np.nan)), "hemoglobin is a volume fraction in [0, 1]; got nan."),
        ((np.zeros((2, 2)), np.zeros((4, 2))), "melanin 2 x 2, hemoglobin 4 x 2. Resize"),
        ((0.1, np.zeros((4, 2)), np.zeros((3, 3, 3))), "hemoglobin 4 x 2, offset 3 x 3. Resize"),
    ],
)
def test_maps_that_do_not_fit_are_refused(arguments, sentence: str) -> None:
    with pytest.raises(InputError, match=re.escape(sentence)):
        MitsubaCapture().skin(*arguments)


def test_another_picture_is_not_developed() -> None:
    with pytest.raises(InputError, match=r"got the shape \(2, 2\)"):
        MitsubaCapture().develop(np.zeros((2, 2)))


def test_a_variant_without_spectra_is_refused() -> None:
    mi.set_variant("scalar_rgb")
    try:
        with pytest.raises(InputError, match="scalar_rgb is set"):
            MitsubaCapture()
    finally:
        mi.set_variant("scalar_spectral")


def test_without_mitsuba_a_sentence_names_the_extra(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "mitsuba", None)
    with pytest.raises(InputError, match=r'pip install "skinnet\[mitsuba\]"'):
        MitsubaCapture()
