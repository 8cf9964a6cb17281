"""Clips as files: the same frames give the same file."""

from pathlib import Path

import numpy as np
import pytest
from scipy import ndimage

from train.synthetic.videos.clip_files import ClipWriter

pytest.importorskip("av")


@pytest.mark.parametrize("side", [192, 200])
def test_the_same_frames_give_the_same_file(tmp_path: Path, side: int) -> None:
    noise = np.random.default_rng(0).normal(128, 200, (side + 20, side, 3))
    smooth = ndimage.gaussian_filter(noise, (3, 3, 0)).clip(0, 255).astype(np.uint8)
    written = set()
    for number in range(4):
        path = tmp_path / f"{number}.mp4"
        writer = ClipWriter(path, 14)
        for frame in range(20):
            writer.add(smooth[frame : frame + side], frame / 30)
        writer.close()
        written.add(path.read_bytes())
    assert len(written) == 1
