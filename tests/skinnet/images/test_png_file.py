from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from skinnet.images._png_file import write_png


def test_png_carries_16_bits_and_text(tmp_path: Path) -> None:
    grey = np.array([[0, 1, 65535]], np.uint16)
    write_png(tmp_path / "a.png", grey, {"scale": "0.5", "unit": "fraction"})
    with Image.open(tmp_path / "a.png") as image:
        np.testing.assert_array_equal(np.asarray(image), grey)
        assert image.text == {"scale": "0.5", "unit": "fraction"}


def test_png_refuses_other_arrays(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="PNG is written from"):
        write_png(tmp_path / "a.png", np.zeros((2, 2, 3), np.uint16))
    assert not list(tmp_path.iterdir())
