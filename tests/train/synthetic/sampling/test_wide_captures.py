"""Wide captures: their width, what is told of them, and lights that are balanced on the whole."""

import numpy as np
import torch

from skinnet.physics import LIGHTS
from train.synthetic.sampling.scene_sampling import sample_camera, sample_light
from train.synthetic.sampling.wide_captures import widen_camera, widen_light


def sample(count: int) -> tuple[list, list]:
    rng = np.random.default_rng(0)
    lights = [widen_light(sample_light(rng), rng) for _ in range(count)]
    return lights, [widen_camera(sample_camera(rng, 4), rng) for _ in range(count)]


def test_all_lights_occur_and_are_mixtures() -> None:
    lights, _ = sample(400)
    mixtures = torch.stack([light.mixture for light in lights])
    torch.testing.assert_close(mixtures.sum(1), torch.ones(400), rtol=0, atol=1e-5)
    assert mixtures.min() >= 0
    main = mixtures.argmax(1).bincount(minlength=len(LIGHTS))
    assert (main > 0).all() and main[0] > 200


def test_coloured_lights_are_neutral_on_the_whole() -> None:
    lights, _ = sample(400)
    mixed = [light for light in lights if light.tints.any()]
    assert 100 < len(mixed) < 220
    for light in mixed:
        power = torch.cat([light.sky[:1], light.strength])
        assert (power @ light.tints).abs().max() < 1e-4
        assert light.tints[:, 1].abs().max() < 1.5


def test_linear_pictures_have_no_curve_and_no_processing() -> None:
    _, cameras = sample(400)
    linear = [one for one in cameras if one.linear]
    assert 20 < len(linear) < 80
    for camera in linear:
        assert not camera.tone.any() and not any(part.any() for part in camera.processing)
    assert not any(one.known.linear for one in cameras if not one.linear)


def test_many_pictures_are_read_blind_and_many_with_all_known() -> None:
    _, cameras = sample(600)
    known = torch.stack([torch.stack([*one.known[:4]]) for one in cameras])
    assert 0.35 < (known.sum(1) == 0).float().mean() < 0.6
    assert 0.1 < (known.sum(1) == 4).float().mean() < 0.35
    assert (known[:, 2] > known[:, 1]).any()  # a temperature without its light
    assert (known.mean(0) > 0.15).all()


def test_white_is_assumed_wrongly_in_both_directions() -> None:
    _, cameras = sample(600)
    errors = torch.stack([one.mired_error for one in cameras])
    assert abs(errors.mean()) < 3 and 8 < errors.std() < 25
