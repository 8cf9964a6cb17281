"""The uncertainty is scaled so that its intervals hold what they say."""

from pathlib import Path

import numpy as np
import pytest
import torch

from skinnet.network import AutoencoderConfig, SkinAutoencoder
from train.calibrate import Evidence, _squash, calibrate, collect_evidence, join, main
from train.residuals import Residuals
from train.synthetic.faces import SyntheticFaces


def make_residuals(
    scale: tuple[float, float], by_tone: float = 0.0, count: int = 20_000
) -> Residuals:
    rng = torch.Generator().manual_seed(0)
    deviation = 0.1 + torch.rand(2, count, generator=rng)
    tone = 3 * torch.rand(count, generator=rng) - 1.5
    factor = torch.tensor(scale)[:, None] * (by_tone * tone).exp()
    error = factor * deviation * torch.randn(2, count, generator=rng)
    return Residuals(error, deviation, tone, tone)


def test_the_scale_is_that_of_the_errors() -> None:
    scale, by_tone = make_residuals((2.0, 0.5)).find_scale()
    torch.testing.assert_close(scale, torch.tensor([2.0, 0.5]), rtol=0.05, atol=0)
    torch.testing.assert_close(by_tone, torch.zeros(2, 2), rtol=0, atol=0.03)


def test_each_tone_has_its_scale() -> None:
    residuals = make_residuals((2.0, 0.5), by_tone=0.4)
    scale, by_tone = residuals.find_scale()
    torch.testing.assert_close(by_tone, torch.tensor([[0.4, 0.0]] * 2), rtol=0, atol=0.06)
    factor = scale[:, None] * (by_tone @ torch.stack([residuals.tone, residuals.tone**2])).exp()
    inside = residuals.error.abs() < 1.6449 * factor * residuals.deviation
    for number in range(6):
        mine = (residuals.tone + 1.5).div(0.5).floor() == number
        assert inside[:, mine].float().mean(1).sub(0.9).abs().max() < 0.02


def test_the_share_of_a_region_is_what_remains_of_the_pixels_variance(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    rng, count, share = torch.Generator().manual_seed(1), 40_000, 0.3
    face = 0.1 + 0.1 * torch.rand(2, count, generator=rng)
    pixel = (face**2 + 0.3 * torch.rand(2, count, generator=rng)).sqrt()
    region = (face**2 + share * (pixel**2 - face**2)).sqrt()
    error = region * torch.randn(2, count, generator=rng)
    right = make_residuals((1.0, 1.0))
    tone = torch.zeros(count)
    found = Evidence(right, right, Residuals(error, pixel, tone, tone), face)
    monkeypatch.setattr("train.calibrate.collect_evidence", lambda *_: found)
    model = SkinAutoencoder(AutoencoderConfig(widths=(4, 6)))
    calibrate(model, [None])  # type: ignore[list-item]
    torch.testing.assert_close(model.region_share, torch.full((2,), share), rtol=0.15, atol=0.02)
    torch.testing.assert_close(model.sd_scale, torch.ones(2, 2), rtol=0.05, atol=0)


def test_far_out_errors_count_as_four_median_ones() -> None:
    error = torch.tensor([[1.0, -1.0, 1.0, 50.0], [2.0, 2.0, -2.0, 3.0]])
    expected = torch.tensor([[1.0, 1.0, 1.0, 16.0], [4.0, 4.0, 4.0, 9.0]])
    torch.testing.assert_close(_squash(error), expected)


def test_evidence_is_collected_where_there_is_skin(casts: Path) -> None:
    data = SyntheticFaces(64, 4, val_heads=2, val_samples=4, geometry=str(casts), captures="wide")
    data.setup("validate")
    (scenes,) = data.val_dataloader()
    batch = data.render(scenes, "val")
    model = SkinAutoencoder(AutoencoderConfig(widths=(4, 6))).eval()
    with torch.no_grad():
        one = collect_evidence(model, batch)
    assert one.face.error.shape == (2, 4) and one.region.error.shape == one.region_face.shape
    assert one.pixel.error.shape[1] == -(-int((batch.mask > 0.5).sum()) // 97)
    both = join([one, one])
    assert both.face.error.shape == (2, 8)


def test_a_model_is_calibrated_and_saved(casts: Path, tmp_path: Path) -> None:
    torch.manual_seed(0)
    SkinAutoencoder(AutoencoderConfig(widths=(4, 6), working_size=64)).save_pretrained(
        tmp_path / "a.safetensors"
    )
    arguments = ("--geometry", str(casts), "--heads", "2", "--samples", "8")
    files = [str(tmp_path / f"{name}.safetensors") for name in "ab"]
    assert main([files[0], "-o", files[1], *arguments]) == 0
    before, after = (SkinAutoencoder.from_pretrained(file) for file in files)
    assert np.all(before.sd_scale.numpy() == 1) and not np.any(after.sd_scale.numpy() == 1)


def test_a_missing_model_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main([str(tmp_path / "a.ckpt"), "-o", str(tmp_path / "b.safetensors")]) == 2
    assert "There is no checkpoint" in capsys.readouterr().err


def test_no_pictures_are_refused(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["a.safetensors", "-o", "b.safetensors", "--samples", "0"]) == 2
    assert "got --heads 64 and --samples 0" in capsys.readouterr().err
