"""Photographs as training data."""

from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from skimage.data import astronaut

from skinnet.errors import InputError
from train.portraits import Crop, Crops, find_crops


def test_a_face_is_found_cropped_and_masked(tmp_path: Path) -> None:
    Image.fromarray(astronaut()).save(tmp_path / "astronaut.png")
    (crop,) = find_crops(tmp_path, 64)
    assert crop.photograph.shape == (64, 64, 3) and crop.mask.shape == (64, 64)
    assert 0.08 < (crop.mask > 127).mean() < 0.6


def test_pictures_without_a_face_are_skipped_and_counted(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    Image.fromarray(astronaut()).save(tmp_path / "a.png")
    Image.new("RGB", (80, 80)).save(tmp_path / "black.png")
    (tmp_path / "broken.jpg").write_bytes(b"no picture")
    assert len(find_crops(tmp_path, 32)) == 1
    assert "1 faces, 2 pictures skipped" in capsys.readouterr().err


def test_a_folder_without_faces_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="holds no photograph"):
        find_crops(tmp_path, 32)
    with pytest.raises(InputError, match="not a folder"):
        find_crops(tmp_path / "absent", 32)


def test_every_epoch_shows_every_photograph_once_in_its_own_order() -> None:
    grey = [Crop(np.full((2, 2, 3), n, np.uint8), np.zeros((2, 2), np.uint8)) for n in range(20)]
    crops = Crops(grey, seed=1)
    epochs = [[int(crops[20 * e + i].photograph[0, 0, 0]) for i in range(20)] for e in range(2)]
    assert sorted(epochs[0]) == sorted(epochs[1]) == list(range(20))
    assert epochs[0] != epochs[1]
