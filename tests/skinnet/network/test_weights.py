"""Files of weights carry what is needed to rebuild the model."""

from pathlib import Path

import pytest
import torch

from skinnet.errors import InputError
from skinnet.network import AutoencoderConfig, SkinAutoencoder
from skinnet.network._weights import read_weights


def test_configuration_training_data_and_weights_are_kept(tmp_path: Path) -> None:
    model = SkinAutoencoder(AutoencoderConfig(widths=(4, 6), working_size=48))
    model.trained_on = "noise"
    model.save_pretrained(tmp_path / "model.safetensors")
    saved = read_weights(tmp_path / "model.safetensors")
    assert saved.trained_on == "noise"
    assert saved.config == {
        "optics": "measured",
        "widths": [4, 6],
        "working_size": 48,
        "white_balance_max": 0.9,
    }
    again = SkinAutoencoder.from_pretrained(tmp_path / "model.safetensors")
    photograph = torch.rand(1, 3, 9, 7)
    expected = model.eval()(photograph).reconstruction
    torch.testing.assert_close(again(photograph).reconstruction, expected)


def test_a_missing_file_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"absent\.safetensors is not a file"):
        SkinAutoencoder.from_pretrained(tmp_path / "absent.safetensors")


@pytest.mark.parametrize("value", [float("nan"), float("inf"), 1e30])
@pytest.mark.parametrize("suffix", [".safetensors", ".ckpt"])
def test_weights_that_are_no_numbers_are_refused(tmp_path: Path, value: float, suffix: str) -> None:
    model = SkinAutoencoder(AutoencoderConfig(widths=(4, 6)))
    with torch.no_grad():
        next(model.encoder.parameters()).view(-1)[3] = value
    path = tmp_path / f"model{suffix}"
    if suffix == ".ckpt":
        torch.save(model.make_checkpoint(), path)
    else:
        model.save_pretrained(path)
    with pytest.raises(
        InputError, match=rf"{path.name} has weights .*: (nan|inf|1e\+30) in (model\.)?enc"
    ):
        SkinAutoencoder.from_pretrained(path)


@pytest.mark.parametrize("widths", [[4, 0], [10**6], [4] * 9, "wide", None, [[4]]])
def test_a_configuration_that_no_machine_can_build_is_refused(
    tmp_path: Path, widths: object
) -> None:
    content = SkinAutoencoder(AutoencoderConfig(widths=(4, 6))).make_checkpoint()
    content["skinnet"]["widths"] = widths
    torch.save(content, tmp_path / "model.ckpt")
    with pytest.raises(InputError):
        SkinAutoencoder.from_pretrained(tmp_path / "model.ckpt")
