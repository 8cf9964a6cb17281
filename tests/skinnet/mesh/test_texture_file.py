"""Texture files: pixels as stored, faults in sentences."""

from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from skinnet.errors import InputError
from skinnet.images import _decode
from skinnet.mesh._texture_file import open_texture


def save(path: Path, size: tuple[int, int] = (4, 3)) -> Path:
    Image.new("RGB", size, (200, 120, 90)).save(path)
    return path


def test_rows_and_columns_are_as_stored_whatever_the_exif_says(tmp_path: Path) -> None:
    image, exif = Image.new("RGB", (20, 10), (200, 0, 0)), Image.Exif()
    exif[0x0112] = 6
    image.save(tmp_path / "turned.jpg", exif=exif)
    assert open_texture(tmp_path / "turned.jpg").srgb.shape == (10, 20, 3)


def test_transparency_is_composited_on_white(tmp_path: Path) -> None:
    Image.new("RGBA", (2, 2), (0, 0, 0, 0)).save(tmp_path / "clear.png")
    assert (open_texture(tmp_path / "clear.png").srgb == 255).all()


def test_pixels_come_back(tmp_path: Path) -> None:
    pixels = np.random.default_rng(0).integers(0, 256, (5, 7, 3), np.uint8)
    Image.fromarray(pixels).save(tmp_path / "noise.png")
    assert np.array_equal(open_texture(tmp_path / "noise.png").srgb, pixels)


def test_faults_are_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(InputError, match=r"There is no texture .*none\.png"):
        open_texture(tmp_path / "none.png")
    (tmp_path / "text.png").write_text("not a picture")
    with pytest.raises(InputError, match=r"text\.png is not a picture"):
        open_texture(tmp_path / "text.png")
    path = save(tmp_path / "cut.png", (64, 64))
    whole = path.read_bytes()
    path.write_bytes(whole[:80])
    with pytest.raises(InputError, match=r"cut\.png is (damaged|not a picture)"):
        open_texture(path)
    path.write_bytes(whole)
    monkeypatch.setattr(_decode, "MAX_PIXELS", 100)
    with pytest.raises(InputError, match="64 x 64, more pixels than the limit of 100"):
        open_texture(path)
