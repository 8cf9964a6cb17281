"""Weights of ONNX files that no training finds are refused before a photograph is read."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import onnx
import pytest
from onnx import numpy_helper

from skinnet.errors import InputError
from skinnet.inference import SHIPPED_ENCODER, open_model
from skinnet.inference._onnx_weights import check_weights


def change(path: Path, name: str, value: float, raw: bool = True) -> Path:
    """Set a weight of a file to a value."""
    model = onnx.load(path)
    (weight,) = (each for each in model.graph.initializer if each.name == name)
    array = np.full_like(numpy_helper.to_array(weight), value)
    weight.CopyFrom(numpy_helper.from_array(array, name))
    if not raw:
        weight.ClearField("raw_data")
        weight.float_data.extend(array.ravel().tolist())
    onnx.save(model, path)
    return path


@pytest.mark.parametrize("value", [np.nan, np.inf, 1e30])
@pytest.mark.parametrize("raw", [True, False])
def test_weights_that_are_no_numbers(
    save_model: Callable[..., Path], value: float, raw: bool
) -> None:
    path = change(save_model(), "fifth", value, raw)
    with pytest.raises(InputError, match=r"changed\.onnx has weights .* in fifth; give a file"):
        open_model(path, "encoder")


def test_the_shipped_models_have_sound_weights() -> None:
    for path in SHIPPED_ENCODER.parent.glob("*.onnx"):
        check_weights(path, "")


def test_outputs_that_are_no_numbers(save_model: Callable[..., Path]) -> None:
    """Weights of allowed size may still divide by zero."""
    model = open_model(change(save_model(), "white", 0.0), "encoder")
    with pytest.raises(InputError, match="numbers that are not finite"):
        model.run({"image": np.zeros((1, 4, 4, 3), np.uint8)})


def test_a_name_that_is_not_utf_8(
    save_model: Callable[..., Path], capfd: pytest.CaptureFixture[str]
) -> None:
    path = save_model()
    path.write_bytes(path.read_bytes().replace(b"hemoglobin", b"hem\xffglobin"))
    with pytest.raises(InputError, match=r"changed\.onnx"):
        open_model(path, "encoder")
    assert capfd.readouterr() == ("", "")
