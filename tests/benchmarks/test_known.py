"""What is known of the captures of rendered faces, step by step, and the keys of the benchmark."""

from pathlib import Path

import numpy as np
import pytest
import torch

from benchmarks.known import Read, climb, measure, score_ladder, to_tensors
from benchmarks.repeated_faces import RepeatedFaces
from benchmarks.skin_readings import SkinReading
from skinnet.errors import InputError
from skinnet.inference import Capture
from skinnet.physics import LIGHTS

STEPS = ("nothing", "white", "chart", "light", "light_and_camera", "raw")


def test_each_step_knows_more(tmp_path: Path) -> None:
    settings = RepeatedFaces(people=2, shots=1, heads=1, size=32, ict=None, geometry=str(tmp_path))
    data = settings.make_faces()
    rung = climb(data, data.test_dataloader().dataset[1], 1)
    assert tuple(rung.steps) == STEPS and np.isfinite(rung.truth).all()
    nothing, white, chart, lit, named, raw = rung.steps.values()
    assert nothing.told is None and (nothing.photograph == white.photograph).all()
    assert white.told.light is None and named.told.light.shape == (1, len(LIGHTS))
    assert lit.told.camera is None and lit.told.temperature is not None
    assert named.told.linear is None and float(raw.told.linear) == 1
    assert (raw.photograph != nothing.photograph).any()
    # The chart and the card are two measurements of one balance, after and before the tone curve.
    torch.testing.assert_close(chart.told.white_balance, raw.told.white_balance, atol=0.08, rtol=0)


def test_names_of_lights_become_weights() -> None:
    told = to_tensors(Capture(light={"A": 1.0}, white_balance=(0.1, -0.1), linear=True))
    assert told.light[0, LIGHTS.index("A")] == told.light.sum() == 1
    assert told.temperature is None and told.linear.tolist() == [1]


def test_scores_of_the_ladder() -> None:
    rng = np.random.default_rng(0)
    truths = rng.normal(-3, 0.5, (40, 2))

    def read(truth: np.ndarray, noise: float) -> SkinReading:
        return SkinReading(truth + noise * rng.standard_normal(2), np.full(2, noise), {})

    faces = [
        Read(one, {"nothing": read(one, 0.4), "chart": read(one, 0.05)}, place < 10)
        for place, one in enumerate(truths)
    ]
    found = score_ladder(faces)
    assert found["chart"]["refused"] == pytest.approx(0.25)
    for name in ("melanin", "hemoglobin"):
        rough, sharp = found["nothing"][name], found["chart"][name]
        assert rough["r_image"] < 0.95 < sharp["r_image"] and sharp["error"] < 0.1
        assert 0.7 < rough["coverage"] <= 1


def test_too_few_faces_are_refused() -> None:
    with pytest.raises(InputError, match="3 faces or more; got 2"):
        measure(faces=2)
