"""The shipped model gives plausible maps, the same in torch and in onnxruntime."""

import re

import numpy as np
import pytest
import torch
from skimage.color import rgb2lab
from skimage.data import astronaut

from skinnet import Decomposer, Decomposition
from skinnet.images import srgb_to_linear
from skinnet.inference import CAPTURE_NAMES, MAP_NAMES, SHIPPED_ENCODER, Capture
from skinnet.network import SkinAutoencoder
from skinnet.physics import to_display

MODELS = SHIPPED_ENCODER.parent


@pytest.fixture(scope="module")
def decomposition() -> Decomposition:
    return Decomposer()(astronaut())


@pytest.fixture(scope="module")
def skin(decomposition: Decomposition) -> np.ndarray:
    return decomposition.mask > 0.5


def test_the_models_take_at_most_ten_megabytes() -> None:
    assert sum(path.stat().st_size for path in MODELS.iterdir()) <= 10e6


def test_the_card_names_the_runs_that_trained_the_model() -> None:
    card = " ".join((MODELS / "MODEL_CARD.md").read_text(encoding="utf-8").split())
    trained_on = Decomposer().encoder.trained_on
    runs = re.findall(r"\d+ steps", trained_on)
    places = [card.index(f" {run}") for run in runs]
    assert len(runs) == 14 and places == sorted(places)
    for setting in ("seed 0", "160 px"):
        assert setting in trained_on and setting in card


def test_torch_and_onnxruntime_agree() -> None:
    photograph = astronaut()[None, :200:2, 120:300:2]
    encoder, decoder = Decomposer().encoder, Decomposer().decoder
    outputs = encoder.run({"image": photograph})
    with torch.no_grad():
        reading = SkinAutoencoder.from_pretrained()(
            torch.from_numpy(photograph).movedim(-1, 1) / 255
        )
    maps = reading.maps._replace(offset=reading.maps.offset.movedim(1, -1))
    for name in ("melanin", "hemoglobin", "shading", "mask", "offset"):
        assert np.abs(outputs[name] - getattr(maps, name).numpy()).max() < 1e-3
    image = decoder.run({name: outputs[name] for name in (*MAP_NAMES, *CAPTURE_NAMES)})["image"]
    expected = to_display(reading.reconstruction).movedim(1, -1).numpy()
    assert np.abs(image - expected).max() < 2e-3


def test_fractions_are_those_of_skin(decomposition: Decomposition, skin: np.ndarray) -> None:
    assert 0.08 < skin[decomposition.box.slices].mean() < 0.5
    assert 0.01 < np.median(decomposition.melanin[skin]) < 0.1
    assert 0.01 < np.median(decomposition.hemoglobin[skin]) < 0.1
    assert decomposition.melanin.max() <= 0.43 and decomposition.hemoglobin.max() <= 0.15


def test_maps_are_smooth_on_skin(decomposition: Decomposition, skin: np.ndarray) -> None:
    for values in (decomposition.melanin, decomposition.hemoglobin):
        steps = np.abs(np.diff(values, axis=1))[skin[:, 1:] & skin[:, :-1]]
        assert steps.mean() < 0.05 * values[skin].mean()


def test_the_reconstruction_resembles_the_photograph(
    decomposition: Decomposition, skin: np.ndarray
) -> None:
    error = srgb_to_linear(decomposition.reconstruction) - srgb_to_linear(astronaut())
    assert np.sqrt((error[skin] ** 2).mean()) < 0.04
    assert np.sqrt((error[decomposition.box.slices] ** 2).mean()) < 0.04


def test_edits_are_a_tan_and_a_flush(skin: np.ndarray) -> None:
    photograph = astronaut()
    decompose = Decomposer()
    tanned = decompose.edit(photograph, melanin=1.5)
    flushed = decompose.edit(photograph, hemoglobin=2.0)
    before, tan, flush = (rgb2lab(image)[skin].mean(0) for image in (photograph, tanned, flushed))
    assert tan[0] < before[0] - 1 and tan[2] > before[2]
    assert flush[0] < before[0] and flush[1] > before[1] + 1
    untouched = (tanned == photograph).all(-1) & (flushed == photograph).all(-1)
    assert untouched[: photograph.shape[0] // 10].all() and untouched.mean() > 0.8


def test_the_shipped_files_are_in_the_package() -> None:
    names = {path.name for path in SHIPPED_ENCODER.parent.iterdir()}
    files = {"skin.onnx", "skin.decoder.onnx", "skin.safetensors"}
    assert names == files | {"MODEL_CARD.md", "CHANGELOG.md"}


def test_a_coloured_thing_that_is_given_as_white_has_a_note() -> None:
    blue, grey = (
        Decomposer()(astronaut(), detail=False, capture=Capture.from_white(colour)).notes
        for colour in ((120, 160, 220), (200, 190, 170))
    )
    assert any("is far from what is seen without it" in note for note in blue)
    assert not grey
