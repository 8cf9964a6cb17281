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


@pytest.mark.parametrize("shape", [(1, 1), (7, 1), (1, 9), (40, 31), (1, 1, 3), (17, 12, 3)])
def test_pixels_are_those_that_are_written(shape: tuple[int, ...], tmp_path: Path) -> None:
    rng = np.random.default_rng(0)
    kind = np.uint8 if len(shape) == 3 else np.uint16
    array = rng.integers(0, np.iinfo(kind).max, shape, kind, endpoint=True)
    large = rng.integers(0, np.iinfo(kind).max, (2 * shape[0], 3 * shape[1], *shape[2:]), kind)
    for number, each in enumerate((array, np.asfortranarray(array), large[::2, ::3])):
        path = tmp_path / f"{number}.png"
        write_png(path, each, {"unit": "µm", "Description": "κ"})
        with Image.open(path) as image:
            image.verify()
        with Image.open(path) as image:
            np.testing.assert_array_equal(np.asarray(image), each)
            assert image.text == {"unit": "µm", "Description": "κ"}


def test_png_refuses_other_arrays(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="PNG is written from"):
        write_png(tmp_path / "a.png", np.zeros((2, 2, 3), np.uint16))
    assert not list(tmp_path.iterdir())
