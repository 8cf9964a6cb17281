"""Spectra in files: columns by name, units by range."""

from pathlib import Path

import numpy as np
import pytest

from skinnet.errors import InputError
from skinnet.physics._spectrum_file import read_camera, read_light

BANDS = np.arange(400.0, 721.0, 10)


def write(path: Path, scale: float, heading: str = "") -> Path:
    rows = [f"{scale * w:.9g},{w}" for w in range(390, 731, 10)]
    path.write_text("\n".join([heading, *rows]), encoding="utf-8")
    return path


@pytest.mark.parametrize("scale", [1, 1e-3, 10, 1e-9])
def test_the_unit_is_that_in_which_the_bands_are_covered(tmp_path: Path, scale: float) -> None:
    found = read_light(write(tmp_path / "a.csv", scale))
    np.testing.assert_allclose(found / found[0], BANDS / BANDS[0], rtol=1e-6)


def test_a_unit_that_contradicts_the_numbers_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"states 'wavelength \(nm\)'.*look like micrometres"):
        read_light(write(tmp_path / "a.csv", 1e-3, "wavelength (nm),power"))


def test_channels_are_taken_by_name(tmp_path: Path) -> None:
    rows = [f"{w},{800 - w},560,{w - 350}" for w in range(390, 731, 10)]
    (tmp_path / "a.csv").write_text("\n".join(["nm,b,g,r", *rows]))
    found = read_camera(tmp_path / "a.csv")
    np.testing.assert_allclose(found[-1] / found[0], [370 / 50, 1, 80 / 400])
