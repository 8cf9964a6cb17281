"""Slow errors of patches whose size is known."""

import numpy as np

from skinnet.video._regions import NAMES
from skinnet.video._slow_errors import SlowErrors

SIDE, PATCH = 96, 8
INSIDE = np.ones((SIDE, SIDE), bool)


def make_regions() -> np.ndarray:
    """Six regions of 16 x 96 texels, and the face, which is all of them but the lips."""
    masks = np.zeros((len(NAMES), SIDE, SIDE), bool)
    for index in range(1, len(NAMES)):
        masks[index, 16 * (index - 1) : 16 * index] = True
    masks[0] = masks[1:].any(0) & ~masks[NAMES.index("lips")]
    return masks.reshape(len(NAMES), -1)


def feed(error: float, smooth: float, noise: float) -> SlowErrors:
    rng, slow = np.random.default_rng(0), SlowErrors(make_regions(), INSIDE)
    blocks = rng.normal(0, error, (SIDE // PATCH, SIDE // PATCH, 3))
    held = np.kron(blocks, np.ones((PATCH, PATCH, 1))).reshape(-1, 3)
    for number in range(90):
        ratios = held + smooth + rng.normal(0, noise, held.shape)
        slow.add(number / 30, ratios, np.ones(len(held), bool))
    return slow


def test_the_error_of_a_region_is_that_of_its_patches_over_their_number() -> None:
    slow = feed(0.02, 0.3, 0.0)
    sds = np.sqrt(np.diagonal(slow.covariance, axis1=1, axis2=2))
    assert np.allclose(sds[1:], 0.02 / np.sqrt(24), rtol=0.2)


def test_a_change_of_the_whole_face_and_noise_of_frames_are_none() -> None:
    covariance = feed(0.0, 0.3, 0.01).covariance
    assert np.sqrt(np.trace(covariance, axis1=1, axis2=2)).max() < 0.001


def test_hidden_texels_count_for_nothing() -> None:
    slow = feed(0.02, 0.0, 0.0)
    before = slow.covariance
    slow.add(3.0, np.full((SIDE**2, 3), 9.0), np.zeros(SIDE**2, bool))
    assert np.allclose(slow.covariance, before)


def test_a_face_without_skin_has_none() -> None:
    slow = SlowErrors(np.zeros((len(NAMES), SIDE**2), bool), INSIDE)
    slow.add(0.0, np.zeros((SIDE**2, 3)), np.ones(SIDE**2, bool))
    assert not slow.covariance.any()
