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
