"""Expressions redden skin that is pressed together, on the side that moves."""

from pathlib import Path

import numpy as np
import pytest

from skinnet.appearance import DynamicModel
from train.dynamic.strains import draw_strains
from train.synthetic.bodies.ict_model import read_ict_model


def test_a_smile_presses_its_own_cheek(shared_data: Path) -> None:
    path = shared_data / "models" / "ict_facekit.npz"
    if not path.is_file():
        pytest.skip("There is no ../shared/data/models/ict_facekit.npz.")
    model, size = read_ict_model(path), 32
    line = (np.arange(size) + 0.5) / size
    x, y = np.meshgrid(line, line)
    angles = np.stack([3 * (x - 0.5), 1.5 * (0.5 - y)], -1)
    fields = draw_strains(model, angles, DynamicModel.load().landmarks.astype(float))
    assert fields.shape == (len(model.names), size, size) and np.isfinite(fields).all()
    assert 0.03 < np.abs(fields).max() <= 0.2 and not fields[:, 0].any()
    left, right = (fields[model.names.index(f"mouthSmile_{side}")] for side in "LR")
    assert np.abs(left[:, 16:]).sum() > 2 * np.abs(left[:, :16]).sum()
    assert np.abs(right[:, :16]).sum() > 2 * np.abs(right[:, 16:]).sum()
