"""The shipped model gives its golden outputs in torch and in onnxruntime."""

import json
from collections.abc import Callable

import numpy as np
import pytest
import torch

from skinnet.inference import SHIPPED_ENCODER, open_model
from skinnet.network import SkinAutoencoder
from tools.golden import GOLDEN_FILE, load_photograph, summarise_outputs

OUTPUTS = json.loads(GOLDEN_FILE.read_text(encoding="utf-8"))
TOLERANCE = {"temperature": 20.0}  # kelvin; the others are of the order of one


def run_onnxruntime() -> dict[str, np.ndarray]:
    return open_model(SHIPPED_ENCODER, "encoder", 1).run({"image": load_photograph()})


def run_torch() -> dict[str, np.ndarray]:
    image = torch.from_numpy(load_photograph()).movedim(-1, 1).float() / 255
    with torch.no_grad():
        maps, capture, uncertainty = SkinAutoencoder.from_pretrained().encode(image)
    named = {**maps._asdict(), **capture._asdict(), "offset": maps.offset.movedim(1, -1)}
    named |= {f"{name}_sd": value for name, value in uncertainty._asdict().items()}
    return {name: value.numpy() for name, value in named.items() if value is not None}


@pytest.mark.parametrize("run", [run_onnxruntime, run_torch])
def test_outputs_are_the_golden_ones(run: Callable[[], dict[str, np.ndarray]]) -> None:
    actual = summarise_outputs(run())
    assert actual.keys() == OUTPUTS.keys()
    for name, expected in OUTPUTS.items():
        np.testing.assert_allclose(
            actual[name], expected, rtol=0, atol=TOLERANCE.get(name, 1e-3), err_msg=name
        )
