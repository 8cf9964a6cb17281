"""What EXIF states of a shot, and damaged EXIF that states nothing."""

import io

import numpy as np
import pytest
from PIL import Image

from skinnet.images import read_picture
from skinnet.images._shot import Shot, read_shot

_MAKE, _MODEL, _EXIF = 0x010F, 0x0110, 0x8769
_LIGHT_SOURCE, _FLASH, _WHITE_BALANCE = 0x9208, 0x9209, 0xA403


def make_exif(make: str = "", model: str = "", **inner: int) -> bytes:
    exif = Image.Exif()
    exif[_MAKE], exif[_MODEL] = make, model
    tags = {"light": _LIGHT_SOURCE, "flash": _FLASH, "balance": _WHITE_BALANCE}
    exif.get_ifd(_EXIF).update({tags[name]: value for name, value in inner.items()})
    return exif.tobytes().removeprefix(b"Exif\0\0")


@pytest.mark.parametrize(
    ("make", "model", "camera"),
    [
        ("NIKON CORPORATION", "NIKON D700", "NIKON D700"),
        ("Canon", "Canon EOS 5D", "Canon EOS 5D"),
        ("SONY", "ILCE-7M3", "SONY ILCE-7M3"),
        ("SONY ", "ILCE-7M3\0\0 ", "SONY ILCE-7M3"),
        ("", "One", "One"),
        ("Acme", "", "Acme"),
        ("", "", None),
    ],
)
def test_a_camera_has_a_maker_and_a_model(make: str, model: str, camera: str | None) -> None:
    assert read_shot(make_exif(make, model)).camera == camera


@pytest.mark.parametrize(("value", "fired"), [(0, False), (1, True), (0x10, False), (0x59, True)])
def test_the_first_bit_of_flash_says_that_it_fired(value: int, fired: bool) -> None:
    assert read_shot(make_exif(flash=value)).flash is fired


def test_settings_of_the_white_balance() -> None:
    assert read_shot(make_exif(balance=0)).white_balance == "auto"
    assert read_shot(make_exif(balance=1, light=3))[2:] == ("manual", "tungsten")
    assert read_shot(make_exif(balance=7, light=0))[2:] == (None, None)


@pytest.mark.parametrize("format_", ["JPEG", "PNG", "TIFF", "WEBP"])
def test_every_format_states_it(format_: str) -> None:
    file = io.BytesIO()
    exif = b"Exif\0\0" + make_exif("Canon", "Canon EOS 5D", flash=9)
    Image.fromarray(np.full((8, 8, 3), 90, np.uint8)).save(file, format_, exif=exif)
    shot = read_shot(read_picture(io.BytesIO(file.getvalue())).metadata["exif"])
    assert shot == Shot("Canon EOS 5D", True, None, None)


@pytest.mark.parametrize("cut", range(0, 120, 7))
def test_damaged_exif_states_nothing_wrong(cut: int) -> None:
    block = make_exif("Canon", "Canon EOS 5D", flash=9, balance=1)
    shot = read_shot(block[:cut])
    assert shot.flash in (None, True) and shot.white_balance in (None, "manual")
