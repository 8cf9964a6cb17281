"""Checkpoints are read as data, and refused in words."""

from pathlib import Path

import pytest
import torch

from skinnet.errors import InputError
from skinnet.network import AutoencoderConfig, SkinAutoencoder, read_checkpoint


def test_a_checkpoint_of_the_model_alone_is_loaded(tmp_path: Path) -> None:
    model = SkinAutoencoder(AutoencoderConfig(widths=(4, 6, 8)))
    model.trained_on = "nothing"
    torch.save(model.make_checkpoint(), tmp_path / "model.ckpt")
    assert read_checkpoint(tmp_path / "model.ckpt")["skinnet"] == model.describe()
    again = SkinAutoencoder.from_pretrained(tmp_path / "model.ckpt")
    assert again.config == model.config and again.trained_on == "nothing"
    state = again.state_dict()
    assert all(torch.equal(value, state[name]) for name, value in model.state_dict().items())


def test_a_checkpoint_of_something_else_is_refused(tmp_path: Path) -> None:
    for content in ([], {}, {"skinnet": "yes"}):
        torch.save(content, tmp_path / "other.ckpt")
        with pytest.raises(InputError, match="is not a checkpoint of skinnet"):
            read_checkpoint(tmp_path / "other.ckpt")
