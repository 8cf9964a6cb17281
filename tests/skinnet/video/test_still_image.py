"""Still images, and heads that are nearly still."""

import numpy as np

from skinnet.video._still_image import StillImage
from skinnet.video._video_frames import Frame
from tests.small_videos import make_frames


def add_all(frames: list[np.ndarray], step: float = 0.5) -> StillImage:
    still = StillImage()
    for number, pixels in enumerate(frames):
        still.add(Frame(step * number, pixels))
    return still


def test_compression_of_a_still_image_is_no_movement() -> None:
    photo = make_frames(1)[0].astype(int)
    frames = [(photo + number % 2).clip(0, 255).astype(np.uint8) for number in range(4)]
    assert add_all(frames).is_still
    assert not add_all(frames, 0.1).is_still  # too short to tell


def test_a_head_that_moves_a_little_is_no_still_image() -> None:
    photo = make_frames(1)[0]
    assert not add_all([photo, photo, photo, np.roll(photo, 1, 1)]).is_still


def test_noise_is_no_still_image() -> None:
    assert not add_all(make_frames(4, 0)).is_still
