"""The shipped model gives its golden outputs, in torch and in onnxruntime alike."""

import json

import numpy as np
import pytest
import torch

from skinnet.inference import SHIPPED_ENCODER, open_model
from skinnet.network import SkinAutoencoder
from tools.golden import GOLDEN, numbers, photograph

OUTPUTS = json.loads(GOLDEN.read_text(encoding="utf-8"))
TOLERANCE = {"temperature": 20.0}  # kelvin; the others are of the order of one


def by_onnxruntime() -> dict[str, np.ndarray]:
    return open_model(SHIPPED_ENCODER, "encoder", 1).run({"image": photograph()})


def by_torch() -> dict[str, np.ndarray]:
    image = torch.from_numpy(photograph()).movedim(-1, 1).float() / 255
    with torch.no_grad():
        maps, capture = SkinAutoencoder.from_pretrained().encode(image)
    named = {**maps._asdict(), **capture._asdict(), "offset": maps.offset.movedim(1, -1)}
    return {name: value.numpy() for name, value in named.items()}


@pytest.mark.parametrize("run", [by_onnxruntime, by_torch])
def test_outputs_are_the_golden_ones(run) -> None:
    found = numbers(run())
    assert found.keys() == OUTPUTS.keys()
    for name, expected in OUTPUTS.items():
        np.testing.assert_allclose(
            found[name], expected, rtol=0, atol=TOLERANCE.get(name, 1e-3), err_msg=name
        )
