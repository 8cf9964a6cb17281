"""The mean of two checkpoints is a model between them."""

from pathlib import Path

import pytest
import torch

from skinnet.network import AutoencoderConfig, SkinAutoencoder
from tools.mean import main


def checkpoint(path: Path, seed: int, width: int = 8) -> SkinAutoencoder:
    torch.manual_seed(seed)
    model = SkinAutoencoder(AutoencoderConfig(widths=(4, width)))
    model.trained_on = f"seed {seed}"
    torch.save(model.make_checkpoint(), path)
    return model


def test_weights_are_half_of_each(tmp_path: Path) -> None:
    names = [tmp_path / f"{name}.ckpt" for name in ("first", "last", "mean")]
    models = [checkpoint(path, seed) for seed, path in enumerate(names[:2])]
    assert main([str(names[0]), str(names[1]), "-o", str(names[2])]) == 0
    found = SkinAutoencoder.from_pretrained(names[2])
    first, last = (model.encoder.global_outputs.weight for model in models)
    torch.testing.assert_close(found.encoder.global_outputs.weight, (first + last) / 2)
    assert (
        found.trained_on.startswith("seed 1; mean") and found(torch.rand(1, 3, 16, 16)) is not None
    )


def test_a_file_goes_into_a_folder_that_is_there(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    first, last, out = tmp_path / "a.ckpt", tmp_path / "b.ckpt", tmp_path / "none" / "out.ckpt"
    checkpoint(first, 0)
    checkpoint(last, 1)
    assert main([str(first), str(last), "-o", str(out)]) == 2
    assert f"{out.parent} is not a folder; make it first." in capsys.readouterr().err


def test_other_shapes_and_missing_files_end_in_a_sentence(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    first, last, out = (tmp_path / name for name in ("a.ckpt", "b.ckpt", "out.ckpt"))
    checkpoint(first, 0)
    checkpoint(last, 1, width=6)
    for other in (first, last, tmp_path / "none.ckpt"):
        assert main([str(first), str(other), "-o", str(out)]) == 2
        message = capsys.readouterr().err
        assert str(other) in message and "Traceback" not in message and not out.exists()


def test_another_file_is_not_replaced(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    first, last, out = (tmp_path / name for name in ("a.ckpt", "b.ckpt", "out.ckpt"))
    checkpoint(first, 0)
    checkpoint(last, 1)
    for taken in (first, last):
        before = taken.read_bytes()
        assert main([str(first), str(last), "-o", str(taken)]) == 2
        assert "is there already and is not this mean" in capsys.readouterr().err
        assert taken.read_bytes() == before
    for _ in range(2):
        assert main([str(first), str(last), "-o", str(out)]) == 0
