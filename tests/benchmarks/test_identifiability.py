"""Predictions from colours are better where less is unknown."""

import pytest
import torch

from benchmarks import identifiability
from benchmarks.identifiability import render_colours, sample_faces, score_network, score_networks
from skinnet.physics import SkinDecoder


@pytest.fixture(autouse=True)
def few(monkeypatch: pytest.MonkeyPatch) -> None:
    sizes = {"SAMPLES": 1500, "SCORED": 300, "STEPS": 150, "BATCH": 512}
    for name, count in sizes.items():
        monkeypatch.setattr(identifiability, name, count)


def test_pigments_are_predicted_from_colours_that_determine_them() -> None:
    torch.manual_seed(0)
    truth = torch.rand(1500, 2).exp()
    found = score_network(truth, truth.log())
    assert min(found["melanin_r"], found["hemoglobin_r"]) > 0.99
    found = score_network(truth, torch.rand(1500, 2))
    assert max(found["melanin_r"], found["hemoglobin_r"]) < 0.3


def test_the_exact_white_balance_of_a_face_improves_hemoglobin() -> None:
    torch.manual_seed(0)
    found = score_networks(sample_faces(1500), SkinDecoder(), measured=False)
    assert list(found) == ["patch", "patch_told", "face", "face_told"]
    given, not_given = found["face_told"]["hemoglobin_r"], found["patch"]["hemoglobin_r"]
    assert given > not_given + 0.05 and found["face"]["melanin_r"] > 0.9


def test_colours_are_those_of_a_display() -> None:
    faces = sample_faces(400)
    colours = render_colours(faces, SkinDecoder(), measured=True)
    assert colours.shape == (400, 21) and colours.max() <= 0
    levels = colours.exp()[colours > colours.min()] * 255
    torch.testing.assert_close(levels, levels.round(), atol=1e-3, rtol=0)
