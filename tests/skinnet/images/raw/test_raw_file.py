"""RAW files of known spectra are read as linear light in the colours of training."""

import io
import sys
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import oracle
import pytest
import tifffile
from raw_files import EXIF_NAMES, light, photograph_spectra, read_patches

from skinnet.errors import InputError
from skinnet.images import _decode, linear_to_srgb, read_picture
from skinnet.images._raw import raw_file
from skinnet.images._raw.raw_file import _check
from skinnet.images._shot import read_shot
from tools.dng import Sensor, write_dng

pytest.importorskip("rawpy")

SPECTRA = np.concatenate(
    [
        oracle.reflectance("measured", np.linspace(0.02, 0.35, 6), np.linspace(0.02, 0.1, 6)),
        np.linspace(0.1, 1, 4)[:, None] * np.ones(33),
    ]
)
GREY = np.full((64, 96, 3), 0.25)
MATRIX = np.linalg.inv(oracle.srgb_to_xyz())


def read(content: bytes, name: str = "a.dng"):
    return read_picture(io.BytesIO(content), name)


@pytest.mark.parametrize("power", ["D65", "A", "LED-B3"])
@pytest.mark.parametrize("camera", EXIF_NAMES)
def test_colours_are_those_of_the_spectra(camera: str, power: str) -> None:
    content, truth = photograph_spectra(SPECTRA, camera, light(power))
    picture = read(content)
    assert picture.pixels.dtype == np.uint16 and picture.format == "RAW" and picture.notes == ()
    assert picture.colour_space[:2] == ("sRGB", "RAW development")
    actual = read_patches(picture.linear())
    np.testing.assert_allclose(actual, truth, rtol=0.01, atol=4e-4)
    np.testing.assert_allclose(actual[-4:], truth[-4:], rtol=2e-3)  # greys


def test_display_pixels_are_those_of_srgb_without_a_tone_curve() -> None:
    content, truth = photograph_spectra(SPECTRA, "Nikon D700", light("D65"))
    shown = read_patches(read(content).srgb)
    np.testing.assert_allclose(shown, 255 * linear_to_srgb(truth), atol=1.5)


@pytest.mark.parametrize("exposure", [0.02, 0.2, 0.9])
def test_nothing_is_brightened(exposure: float) -> None:
    content, _ = photograph_spectra(SPECTRA, "Sony ILCE-7M3", light("D65"), exposure)
    white = read_patches(read(content).linear())[-1]
    np.testing.assert_allclose(white, exposure, rtol=0.01)


def test_what_is_overexposed_is_white() -> None:
    content, _ = photograph_spectra(SPECTRA, "Nikon D700", light("A"), exposure=5.0)
    assert (read_patches(read(content).pixels)[-1] == 65535).all()


def test_a_wrong_white_balance_stays_wrong() -> None:
    """Only the camera's setting is known; what is wrong with it is the network's to find."""
    power = light("A")
    content, _ = photograph_spectra(
        SPECTRA, "Nikon D700", power, exposure=0.3, neutral=(0.5, 1.0, 0.7)
    )
    red, green, blue = read_patches(read(content).linear())[-1]
    assert red > 1.5 * green > 1.5 * blue


def test_a_missing_white_balance_is_that_of_daylight() -> None:
    content, truth = photograph_spectra(SPECTRA, "Nikon D700", light("D65"), neutral=None)
    picture = read(content)
    np.testing.assert_allclose(read_patches(picture.linear()), truth, rtol=0.01, atol=4e-4)
    (note,) = picture.notes
    assert note == "a.dng states no white balance; it is developed for daylight of 6,500 K."


def test_other_cameras_are_developed_by_their_matrix_and_a_note_says_so() -> None:
    picture = read(write_dng(GREY, Sensor(matrix=MATRIX)))
    np.testing.assert_allclose(picture.linear(), 0.25, rtol=0.01)
    (note,) = picture.notes
    assert note.startswith("a.dng is from Acme One, whose sensitivities are not measured;")


def test_other_cameras_are_near_the_truth() -> None:
    """A measured camera under another name: the file's matrix is that of its sensitivities."""
    curves = oracle.measured_cameras()["Canon EOS 5D Mark IV"]
    daylight = light("D65") @ curves
    to_sensor = np.linalg.inv(oracle.camera_to_xyz(curves / daylight)) * daylight[:, None]
    content, truth = photograph_spectra(
        SPECTRA, "Canon EOS 5D Mark IV", light("D65"), matrix=to_sensor / to_sensor.max()
    )
    renamed = content.replace(b"Canon EOS 5D Mark IV", b"Canon EOS 9D Mark XX")
    picture = read(renamed)
    assert len(picture.notes) == 1
    actual = read_patches(picture.linear())[:6]
    np.testing.assert_allclose(actual[:, 0] / actual[:, 1], truth[:6, 0] / truth[:6, 1], rtol=0.12)


@pytest.mark.parametrize("orientation", [1, 3, 6, 8])
def test_pictures_are_upright(orientation: int) -> None:
    values = GREY.copy()
    values[:16, :16] = 0.8
    picture = read(write_dng(values, Sensor(matrix=MATRIX, orientation=orientation)))
    bright = picture.pixels[..., 1] > 40000
    turned = {1: bright, 3: bright[::-1, ::-1], 6: np.rot90(bright), 8: np.rot90(bright, -1)}
    assert turned[orientation][2:14, 2:14].all() and turned[orientation].sum() < 400
    assert picture.pixels.shape[:2] == ((64, 96) if orientation < 4 else (96, 64))


def test_a_preview_is_never_read(tmp_path: Path) -> None:
    """As cameras and converters write it: a preview first, and the sensor in a SubIFD."""
    file = tmp_path / "a.dng"
    sensor = Sensor(matrix=MATRIX)
    whole = write_dng(GREY, sensor)
    with tifffile.TiffFile(io.BytesIO(whole)) as source:
        mosaic = source.pages[0].asarray()
        tags = source.pages[0].tags
        stated = [
            (code, tags[code].dtype, tags[code].count, tags[code].value, True)
            for code in (271, 272, 50706, 50707, 50708, 50721, 50728, 50778)
        ]
        cells = [
            (code, tags[code].dtype, tags[code].count, tags[code].value, True)
            for code in (33421, 33422, 50714, 50717)
        ]
    with tifffile.TiffWriter(file) as writer:
        preview = np.full((32, 48, 3), (255, 0, 0), np.uint8)
        options = {"metadata": None, "software": False}
        writer.write(
            preview, photometric="rgb", subifds=1, subfiletype=1, extratags=stated, **options
        )
        writer.write(mosaic, photometric=32803, subfiletype=0, extratags=cells, **options)
    picture = read_picture(file)
    assert picture.pixels.shape == (64, 96, 3)
    np.testing.assert_allclose(picture.linear(), 0.25, rtol=0.01)


def test_exif_is_kept_without_what_is_no_longer_true() -> None:
    block = read(write_dng(GREY, Sensor(matrix=MATRIX, orientation=6))).metadata["exif"]
    assert read_shot(block).camera == "Acme One"
    with tifffile.TiffFile(io.BytesIO(block)) as file:
        assert set(file.pages[0].tags.keys()) == {271, 272}


@pytest.mark.parametrize("length", [200, 900, 5000, -2000, -10])
def test_a_file_that_is_cut_is_damaged(length: int) -> None:
    content = write_dng(GREY, Sensor(matrix=MATRIX))
    with pytest.raises(InputError, match=r"a\.dng is a RAW file that is damaged or cut short \("):
        read(content[:length])


def test_a_file_without_light_is_damaged() -> None:
    with pytest.raises(InputError, match=r"a\.dng is a RAW file that is damaged .*all black\)"):
        read(write_dng(np.zeros((64, 96, 3)), Sensor(matrix=MATRIX)))


def test_a_file_that_states_more_than_it_holds_is_cut() -> None:
    content = write_dng(GREY, Sensor(matrix=MATRIX))
    with tifffile.TiffFile(io.BytesIO(content)) as file:
        tag = file.pages[0].tags[279]
    longer = bytearray(content)
    longer[tag.valueoffset : tag.valueoffset + 2] = (2 * 64 * 96 + 9).to_bytes(2, "little")
    with pytest.raises(InputError, match=r"a\.dng is a RAW file that is damaged .*in part\)"):
        read(bytes(longer))


def test_a_file_that_is_far_too_small_is_cut(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(raw_file, "_MOST_PIXELS", 0.1)
    with pytest.raises(InputError, match=r"a\.dng is a RAW file that is damaged .*in part\)"):
        read(write_dng(GREY, Sensor(matrix=MATRIX)))


def test_what_libraw_does_not_read_is_named() -> None:
    with pytest.raises(InputError, match=r"a\.nef is a RAW file that LibRaw does not read; conv"):
        read(b"some bytes" * 100, "a.nef")


def test_a_camera_without_colours_is_refused() -> None:
    words = r"RAW file of Acme One, whose colours are not known \(the nearest names.*\); convert it"
    with pytest.raises(InputError, match=words):
        read(write_dng(GREY, Sensor()))


@pytest.mark.parametrize(("count", "words"), [(1, "no colours"), (4, "4 colours")])
def test_sensors_of_other_colours_are_refused(count: int, words: str) -> None:
    raw = SimpleNamespace(sizes=SimpleNamespace(width=9, height=9), num_colors=count)
    with pytest.raises(InputError, match=rf"a\.dng is a RAW file of a sensor of {words}, where 3"):
        _check(raw, "a.dng", 100)


def test_large_files_are_refused_before_they_are_decoded(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(_decode, "MAX_PIXELS", 5000)
    with pytest.raises(InputError, match=r"a\.dng has 96 x 64, more pixels than the limit of 5,00"):
        read(write_dng(GREY, Sensor(matrix=MATRIX)))


def test_the_extra_is_named_where_it_is_missing(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "rawpy", None)
    with pytest.raises(InputError, match=r'needs an extra: pip install "skinnet\[raw\]"'):
        read(write_dng(GREY, Sensor(matrix=MATRIX)))
