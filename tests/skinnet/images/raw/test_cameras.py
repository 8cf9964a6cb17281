"""Measured cameras are found by the names that EXIF and users give them."""

import numpy as np
import pytest

from skinnet.images._raw.cameras import find_camera, list_close_names, read_cameras
from skinnet.physics import load_cameras
from tools import bake_cameras


@pytest.mark.parametrize(
    ("written", "name"),
    [
        ("Nikon D700", "Nikon D700"),
        ("nikon d700", "Nikon D700"),
        ("NIKON CORPORATION NIKON D700", "Nikon D700"),
        ("NIKON CORPORATION NIKON Z f", "Nikon Z f"),
        ("Canon Canon EOS 5D Mark IV", "Canon EOS 5D Mark IV"),
        ("Canon EOS DIGITAL REBEL XTi", "Canon Digital Rebel XTi"),
        ("Canon EOS REBEL T3i", "Canon EOS 600D"),
        ("SONY ILCE-7M3", "Sony ILCE-7M3"),
        ("Sony a7 III", "Sony ILCE-7M3"),
        ("FUJIFILM X-T4", "Fujifilm X-T4"),
        ("FUJIFILM GFX 100", "Fujifilm GFX 100"),
        ("Panasonic DC-GX7MK3", "Panasonic DC-GX9"),
        ("Hasselblad L1D-20c", "Hasselblad L1D-20c"),
    ],
)
def test_a_camera_has_several_names(written: str, name: str) -> None:
    found = find_camera(written)
    assert found is not None and found.name == name


@pytest.mark.parametrize(
    "name", ["", "Nikon", "Nikon D70s", "Nikon D7000 Pro", "FUJIFILM GFX100S", "Apple iPhone 15"]
)
def test_a_similar_name_is_another_camera(name: str) -> None:
    assert find_camera(name) is None


def test_the_nearest_names_are_listed() -> None:
    assert "Nikon D700" in list_close_names("Nikon D701")
    assert len(list_close_names("iPhone")) == 3


def test_the_table_is_what_its_script_writes() -> None:
    coefficients = bake_cameras.project()
    assert [camera.name for camera in read_cameras()] == list(load_cameras())
    for camera in read_cameras():
        np.testing.assert_allclose(camera.coefficients, coefficients[camera.name], atol=1e-4)
        matrix = bake_cameras.make_matrix(load_cameras()[camera.name].numpy())
        np.testing.assert_allclose(camera.matrix, matrix, atol=1e-4)
        np.testing.assert_allclose(camera.matrix.sum(1), 1, atol=2e-4)
