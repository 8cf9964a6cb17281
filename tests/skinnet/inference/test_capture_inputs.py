"""What is known becomes inputs of the encoder, and what cannot be is refused in a sentence."""

import inspect
from pathlib import Path

import numpy as np
import pytest
import torch

from skinnet import Decomposer
from skinnet.errors import InputError
from skinnet.images import linear_to_srgb, srgb_to_linear
from skinnet.inference import SHIPPED_ENCODER, Capture, OnnxModel, open_model
from skinnet.inference._capture_inputs import make_capture_inputs, name_known
from skinnet.inference.capture import _TO_CAMERA
from skinnet.physics import LIGHTS
from skinnet.physics import Capture as PhysicalCapture

NAN, INFINITE = float("nan"), float("inf")


@pytest.fixture(scope="module")
def encoder() -> OnnxModel:
    return open_model(SHIPPED_ENCODER, "encoder", 1)


def test_all_parts_are_inputs(encoder: OnnxModel) -> None:
    capture = Capture({"A": 3.0, "D": 1.0}, 5500, range(6), (0.1, -0.2), True, -0.5)
    inputs = make_capture_inputs(capture, encoder)
    light = np.zeros((1, len(LIGHTS)), np.float32)
    light[0, LIGHTS.index("A")], light[0, LIGHTS.index("D")] = 0.75, 0.25
    expected = {
        "known_light": light,
        "known_temperature": [5500],
        "known_camera": [[0, 1, 2, 3, 4, 5]],
        "known_white_balance": np.float32([[0.1, -0.2]]),
        "known_linear": [1],
        "known_exposure": [-0.5],
    }
    assert list(inputs) == list(expected)
    for name, value in expected.items():
        np.testing.assert_array_equal(inputs[name], value)
        assert inputs[name].dtype == np.float32
    assert name_known(inputs) == Capture._fields


def test_words_for_lights_are_names(encoder: OnnxModel) -> None:
    words, names = (
        make_capture_inputs(Capture(light), encoder)["known_light"]
        for light in ({"Tungsten": 1.0, "daylight": 3.0}, {"A": 1.0, "D": 3.0})
    )
    np.testing.assert_array_equal(words, names)


@pytest.mark.parametrize("shape", [(), (1,)])
def test_tensors_of_physics_are_the_same(shape: tuple[int, ...], encoder: OnnxModel) -> None:
    numbers = Capture([1.0] * len(LIGHTS), 5500.0, [0.5] * 6, (0.1, -0.2), False, 0.0)
    parts = [torch.tensor(part, dtype=torch.float32) for part in numbers]
    tensors = PhysicalCapture(*(part.expand((*shape, *part.shape)) for part in parts))
    one, other = (make_capture_inputs(each, encoder) for each in (numbers, tensors))
    assert one.keys() == other.keys()
    for name, value in one.items():
        np.testing.assert_array_equal(other[name], value)


@pytest.mark.parametrize(
    "capture", [Capture(), Capture([NAN] * 9, NAN, [NAN] * 6, (NAN, NAN), NAN, NAN)]
)
def test_none_and_nan_are_not_known(capture: Capture, encoder: OnnxModel) -> None:
    assert make_capture_inputs(capture, encoder) == {}


@pytest.mark.parametrize(
    ("capture", "sentence"),
    [
        (
            Capture({"dd": 1}),
            r"no light of the name 'dd'; D may be meant\. Give daylight, .* the model: D, A, FL2",
        ),
        (Capture({"ledb3": 1}), "LED-B3 may be meant"),
        (Capture({"xyz": 1}), "no light of the name 'xyz'. Give daylight, flash, tungsten"),
        (Capture({"sunny": 1}), "'sunny'. Give .* such as D65 or 5500K .*: D, A, FL2, FL7"),
        (Capture({"Day light": 1}), "'Day light'; daylight may be meant"),
        (Capture({"flash": 1}), "weights of lights, and 'flash' is daylight of a temperature"),
        (Capture({"D65": 1}), r"Capture\.from_names\(light='D65'\) has both"),
        (Capture([0.5, 0.5]), "light of a capture has 9 values; got 2"),
        (Capture([-1.0] + [1.0] * 8), "weights that are not negative, and not all 0; got -1, 1"),
        (Capture({"D": 0.0}), "weights that are not negative, and not all 0; got 0"),
        (Capture(temperature=3200), "daylight, 4,000 to 25,000 K; got 3200. Lamps are among"),
        (Capture(temperature=30000), "got 30000"),
        (Capture(temperature=[5000, 6000]), "temperature of a capture has 1 value; got 2"),
        (Capture(temperature="warm"), "temperature of a capture is numbers; got 'warm'"),
        (Capture(camera=[0.0] * 5), "camera of a capture has 6 values; got 5"),
        (Capture(camera=[NAN] + [0.0] * 5), "has a value that is not finite .* or None"),
        (Capture(white_balance=(INFINITE, 0.0)), "white_balance .* a value that is not finite"),
        (Capture(linear=0.5), "linear of a capture is true, or false .*; got 0.5"),
    ],
)
def test_what_cannot_be_is_refused(capture: Capture, sentence: str, encoder: OnnxModel) -> None:
    with pytest.raises(InputError, match=sentence):
        make_capture_inputs(capture, encoder)


def test_what_is_no_capture_is_refused(encoder: OnnxModel) -> None:
    unchecked = inspect.unwrap(make_capture_inputs)
    with pytest.raises(InputError, match=r"is a skinnet\.inference\.Capture; got a dict"):
        unchecked({"temperature": 5500}, encoder)


def test_lights_are_those_of_the_file(model_file: Path, astronaut: np.ndarray) -> None:
    known = Capture({"A": 1.0}, 7000.0, white_balance=(0.25, -0.5))
    read = Decomposer(model_file, threads=1)(astronaut, detail=False, capture=known)
    assert read.light == {"D": 0.0, "A": 1.0, "temperature_k": 7000.0}
    balance = read.camera["white_balance"]
    assert [balance["r_over_g"], balance["b_over_g"]] == pytest.approx(np.exp([0.25, -0.5]))
    assert read.camera["components"] == [0.5, -0.5, 0.0]
    assert read.capture_known == ("light", "temperature", "white_balance")
    assert read.summary()["capture_known"] == ["light", "temperature", "white_balance"]


def test_a_known_white_balance_undoes_a_cast(astronaut: np.ndarray) -> None:
    """A photograph in another white balance is read as before if this is said."""
    gain = np.exp([0.35, 0.0, -0.35])
    matrix = (np.linalg.inv(_TO_CAMERA) * gain) @ _TO_CAMERA
    cast = np.rint(255 * linear_to_srgb(0.7 * srgb_to_linear(astronaut) @ matrix.T))
    plain = np.rint(255 * linear_to_srgb(0.7 * srgb_to_linear(astronaut)))
    decomposer = Decomposer(threads=1)
    right, told = (
        decomposer(photo.astype(np.uint8), detail=False, capture=capture).means["melanin"]
        for photo, capture in (
            (plain, Capture(white_balance=(0.0, 0.0))),
            (cast, Capture(white_balance=(0.35, -0.35))),
        )
    )
    assert abs(np.log(told / right)) < 0.2


def test_edits_take_what_is_known(astronaut: np.ndarray) -> None:
    decomposer = Decomposer(threads=1)
    plain = decomposer.edit(astronaut, melanin=2.0)
    warm = decomposer.edit(astronaut, melanin=2.0, capture=Capture(white_balance=(0.2, -0.2)))
    assert not np.array_equal(plain, warm)
    with pytest.raises(InputError, match="temperature of a capture"):
        decomposer.edit(astronaut, melanin=2.0, capture=Capture(temperature=1.0))


@pytest.mark.parametrize(
    ("capture", "message"),
    [
        (Capture(white_balance=(0.1, -30.0)), "between -2 and 2; got -30"),
        (Capture(camera=[0.0, 500.0, 0.0, 0.0, 0.0, 0.0]), "between -10 and 10; got 500"),
        (Capture(exposure=5.0), "between -4 and 4; got 5"),
    ],
)
def test_what_no_photograph_has_is_refused(
    capture: Capture, message: str, encoder: OnnxModel
) -> None:
    with pytest.raises(InputError, match=message):
        make_capture_inputs(capture, encoder)
