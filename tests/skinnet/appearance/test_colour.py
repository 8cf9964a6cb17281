"""Features become the colours of the physics, with gradients, and a record that restores them."""

import json

import numpy as np
import pytest
import torch

from skinnet.appearance.colour import SkinColour
from skinnet.physics import SkinReflectance, SpectralCamera

D = torch.float64


def features(*batch: int, texels: int = 11, seed: int = 0) -> torch.Tensor:
    rng = torch.Generator().manual_seed(seed)
    values = torch.rand(*batch, 5, texels, generator=rng, dtype=D)
    return values * torch.tensor([0.1, 0.4, 0.1, 0.1, 0.1], dtype=D)[:, None]


def test_they_are_the_closed_form_and_the_offset() -> None:
    camera = SpectralCamera(dtype=D)
    matrix = camera.matrix(camera.standard())
    calibration = torch.tensor([[0.9, 0.1, 0], [0, 1.1, 0.2], [0.1, 0, 1]], dtype=D)
    values = features(2, 3)
    spectra = SkinReflectance(dtype=D)(values[..., 1, :], values[..., 0, :])
    expected = (spectra @ matrix @ calibration.T).mT + values[..., 2:, :]
    found = SkinColour(matrix.numpy(), calibration.numpy())(values)
    assert torch.allclose(found, expected, atol=3e-5)
    assert torch.allclose(SkinColour(calibration=calibration.numpy())(values), found)


def test_fractions_outside_count_as_the_nearest(colour: SkinColour) -> None:
    values = torch.tensor([[[-0.5], [1.5], [0.1], [0.2], [0.3]]], requires_grad=True)
    clamped = torch.tensor([[[0.0], [1.0], [0.1], [0.2], [0.3]]])
    assert torch.equal(colour(values), colour(clamped))
    colour(values).sum().backward()
    assert values.grad is not None and values.grad.flatten().tolist() == [0, 0, 1, 1, 1]


def test_the_share_outside_counts_a_texel_once() -> None:
    values = np.full((5, 4), 0.5)
    values[0, 0], values[1, 0], values[1, 1], values[2, 2] = -0.1, 1.1, 1.1, 7
    assert SkinColour.share_outside(values) == 0.5


def test_gradients_are_right(colour: SkinColour) -> None:
    values = features(2, texels=3)
    ours = torch.autograd.functional.jacobian(colour, values)
    matrix = torch.from_numpy(colour.matrix @ colour.calibration.T)
    skin = colour.lookup.reflectance

    def decode_exactly(values: torch.Tensor) -> torch.Tensor:
        rgb = skin.bands(values[..., 1, :], values[..., 0, :]) @ matrix
        return rgb.movedim(-1, -2) + values[..., 2:, :]

    exact = torch.autograd.functional.jacobian(decode_exactly, values)
    assert (ours - exact).abs().max() < 0.01 * exact.abs().max()


def test_a_record_restores_it_exactly(colour: SkinColour) -> None:
    restored = SkinColour.from_record(json.loads(json.dumps(colour.to_record())))
    assert restored.to_record() == colour.to_record()
    assert (restored.light, restored.camera, restored.optics) == ("LED-B3", "D200", "measured")
    assert torch.equal(restored(features(3)), colour(features(3)))


def test_records_of_other_things_are_refused(colour: SkinColour) -> None:
    for change in ({"matrix": [[1.0]]}, {"nodes": [3]}, {"optics": "none"}):
        with pytest.raises(ValueError, match=r"matrix|unpack|none"):
            SkinColour.from_record(colour.to_record() | change)
