"""The map of a face whose blood changes in one half."""

import numpy as np
from skimage.data import astronaut

from skinnet.inference import Decomposer
from skinnet.video import Tracker
from tests.small_videos import RATE, make_frames


def test_the_map_shows_where_blood_changes() -> None:
    tracker = Tracker(Decomposer(threads=1), baseline=(0, 0.2), looks=1)
    readings = []
    for number, frame in enumerate(make_frames(8, 0)):
        flushed = frame.astype(float)
        if number > 5:
            flushed[:, : astronaut().shape[1] // 4] *= (1, 0.9, 0.9)  # the picture's left half
        readings += tracker.add(np.rint(flushed).astype(np.uint8), number / RATE)
    texture = readings[-1].texture
    side = texture.shape[1] // 2
    assert texture.shape == (96, 96) and 0.3 < np.isfinite(texture).mean() < 0.9
    assert np.nanmedian(texture[:, : side - 10]) > np.nanmedian(texture[:, side + 10 :]) + 0.2
