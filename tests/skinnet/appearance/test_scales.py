"""Scales of the hybrid model: equal variance, or equal effect on RGB."""

import numpy as np
import pytest
import torch

from skinnet.appearance._scales import compute_equal_effect, compute_equal_variance
from skinnet.appearance.hybrid import HybridModel
from skinnet.appearance.stack import SubjectStack


def rms(difference: np.ndarray) -> float:
    return float(np.sqrt((difference**2).mean()))


def test_blocks_have_equal_variance_by_default(stack: SubjectStack) -> None:
    model = HybridModel.fit(stack)
    (features,) = stack.read_blocks(model.mask)
    blood, mel, *offset = (features / model.statistics.scales[:, None]).var(0, ddof=1).mean(-1)
    assert np.allclose([blood, mel, sum(offset)], 1, rtol=1e-4)
    assert len(set(model.statistics.scales[2:])) == 1
    assert compute_equal_variance(np.zeros((5, 3, 3)), 10).min() > 0


def test_features_can_be_weighed_by_their_effect(stack: SubjectStack) -> None:
    scales = compute_equal_effect(stack)
    assert np.allclose(scales[2:], 1)
    (features,) = stack.read_blocks(stack.cover().mask)
    mean = features.mean((0, 2))
    for channel in range(5):
        steps = mean + np.outer([-0.5, 0.5], np.eye(5)[channel]) * 1e-3 * scales[channel]
        low, high = stack.colour.double().forward(torch.from_numpy(steps.T)).T
        stack.colour.float()
        assert (high - low).norm() == pytest.approx(1e-3, rel=0.05)
    model = HybridModel.fit(stack, scales=scales)
    assert np.array_equal(model.statistics.scales, scales)
    first = HybridModel.fit(stack, components=1, scales=scales)
    equal = HybridModel.fit(stack, components=1)
    errors = [
        rms(m.reconstruct(m.project(stack.texture(i))) - stack.texture(i).albedo(stack.colour))
        for m in (first, equal)
        for i in range(7)
    ]
    assert sum(errors[:7]) < sum(errors[7:])
