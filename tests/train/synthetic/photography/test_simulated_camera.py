"""Simulated cameras: their sensors, and all that follows them."""

import pytest
import torch

from skinnet.physics import SpectralCamera
from train.synthetic.faces import SyntheticFaces
from train.synthetic.photography.simulated_camera import (
    HELD_OUT,
    apply_tone_curve,
    select_sensors,
    simulate_sensor,
    take_photograph,
)
from train.synthetic.scene import SceneParameters


def test_the_test_split_has_sensors_of_its_own() -> None:
    train, val, test = (set(select_sensors(split)) for split in ("train", "val", "test"))
    assert train == val and not train & test and len(test) == HELD_OUT


def test_a_capture_is_close_to_the_measured_sensor(
    data: SyntheticFaces, scene: SceneParameters
) -> None:
    camera = data.decoder.camera
    matrix, capture = simulate_sensor(scene.light, scene.camera, camera, "train")
    skin = scene.face.skin
    f_mel, f_blood = (one.fraction[:, None, None] for one in (skin.melanin, skin.hemoglobin))
    measured, modelled = (
        data.decoder.albedo(f_mel, f_blood, one) for one in (matrix, camera.matrix(capture))
    )
    assert (measured / modelled).log().abs().max() < 0.15


def test_white_stays_white_under_a_perfect_balance(scene: SceneParameters) -> None:
    balanced = torch.zeros_like(scene.camera.white_balance)
    camera = scene.camera._replace(white_balance=balanced)
    matrix, _ = simulate_sensor(scene.light, camera, SpectralCamera(), "train")
    white = matrix.sum(-2)
    torch.testing.assert_close(white, torch.ones_like(white), atol=2e-3, rtol=0)


@pytest.mark.parametrize("size", [(17, 40), (32, 32)])
def test_a_photograph_keeps_shape_and_range(scene: SceneParameters, size: tuple[int, int]) -> None:
    linear = 1.5 * torch.rand(6, 3, *size, generator=torch.Generator().manual_seed(0))
    camera = scene.camera._replace(quality=torch.full((6,), 40.0), grain=torch.zeros_like(linear))
    photograph = take_photograph(camera, linear)
    assert photograph.shape == linear.shape and photograph.min() >= 0 and photograph.max() <= 1
    assert torch.equal((photograph * 255).round() / 255, photograph)


def test_the_tone_curve_rises(scene: SceneParameters) -> None:
    ramp = torch.linspace(0, 1, 64).expand(6, 3, 8, 64)
    display = apply_tone_curve(scene.camera.tone, ramp)
    assert display.shape == ramp.shape and (display.diff(dim=-1) >= -1e-6).all()
