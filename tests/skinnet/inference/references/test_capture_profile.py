"""A profile is saved and read strictly, and one that does not fit a photograph is noticed."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import yaml
from PIL import Image

from skinnet import Decomposer
from skinnet.errors import InputError
from skinnet.images import read_picture
from skinnet.inference import Capture, CaptureProfile
from skinnet.inference._references.shot_settings import ShotSettings
from skinnet.inference._references.tone_curve import ToneCurve

LIGHT = Capture({"D": 1.0}, 5200.0, (0.5, 0.1, -0.2, 0.3, 0.0, 1.0), (0.02, -0.03), None, -0.2)
FULL = CaptureProfile(
    LIGHT,
    LIGHT._replace(linear=True, exposure=-0.3, white_balance=(0.01, -0.02)),
    ToneCurve(0.1, 0.4, 0.01, 0.05),
    ((1.0, 0.1, 0.0), (0.0, 1.2, 0.1), (0.0, 0.0, 1.3)),
    (1.2, 3.4),
    ("chart.jpg", "classic"),
    ShotSettings("X100", -3.5),
    "JPEG",
)
KNOWN = FULL.linear_capture
assert KNOWN is not None
# The small network of the tests has other cameras.
ANY_CAMERA = replace(
    FULL, capture=LIGHT._replace(camera=None), linear_capture=KNOWN._replace(camera=None)
)
WARM = CaptureProfile(LIGHT._replace(white_balance=(0.7, -0.6)), source=("lamp.jpg", "white"))


def test_a_profile_is_what_was_saved(tmp_path: Path) -> None:
    for number, profile in enumerate((FULL, CaptureProfile(Capture(white_balance=(0.1, 0.0))))):
        path = tmp_path / f"{number}.yaml"
        profile.save(path)
        assert CaptureProfile.load(path) == profile
        assert "&" not in path.read_text() and "!!" not in path.read_text()


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        (lambda found: found.pop("capture"), "damaged: the file has no capture"),
        (lambda found: found.update(extra=1), "the file has the unknown extra"),
        (lambda found: found["capture"].update(gain=1), "capture has the unknown gain"),
        (
            lambda found: found["capture"].update(exposure="hi"),
            r"exposure is 1 number in \[-4, 4\]",
        ),
        (lambda found: found["capture"].update(exposure=True), "got \\[True\\]"),
        (lambda found: found["capture"].update(exposure=float("nan")), "got \\[nan\\]"),
        (lambda found: found["capture"].update(white_balance=[0.1]), "white_balance is 2 numbers"),
        (lambda found: found["capture"].update(camera=[99] * 6), "camera is 6 numbers"),
        (lambda found: found["capture"].update(temperature=900), "temperature is 1 number"),
        (lambda found: found["capture"].update(light={"Z": 1}), "light is weights of D, A"),
        (lambda found: found["capture"].update(light={"D": -1}), "a weight of a light is in"),
        (lambda found: found["capture"].update(light={"D": 0}), "all weights of lights are 0"),
        (lambda found: found["capture"].update(linear=1), "linear is true or false; got 1"),
        (lambda found: found.pop("tone"), "tone and linear_capture belong together"),
        (lambda found: found["tone"].pop("bend"), "tone has no bend"),
        (lambda found: found.update(correction=[[1, 2], [3, 4]]), "three rows of three numbers"),
        (lambda found: found["source"].update(picture=3), "picture is text; got 3"),
        (lambda found: found.update(source=[]), "source is not a list of names and values"),
        (lambda found: found.update(format=9), "has format 9, and this skinnet reads format 1"),
        (lambda found: found.update(kind="other"), "is not a capture profile"),
    ],
)
def test_a_damaged_profile_is_refused(
    tmp_path: Path, change: Callable[[dict], object], sentence: str
) -> None:
    path = tmp_path / "studio.yaml"
    FULL.save(path)
    found = yaml.safe_load(path.read_text())
    change(found)
    path.write_text(yaml.safe_dump(found))
    with pytest.raises(InputError, match=sentence):
        CaptureProfile.load(path)


@pytest.mark.parametrize("content", [b"", b"\xff\xd8\xff\xe0", b"a: [", b"!!python/name:os.system"])
def test_what_is_no_profile_is_named(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "photo.yaml"
    path.write_bytes(content)
    with pytest.raises(InputError, match=r"photo\.yaml is not a capture profile; give a file"):
        CaptureProfile.load(path)
    with pytest.raises(InputError, match="There is no capture profile"):
        CaptureProfile.load(tmp_path / "absent.yaml")
    with pytest.raises(InputError, match=r"is a \.yaml file; got .*studio\.json"):
        FULL.save(tmp_path / "studio.json")


def test_it_is_given_as_a_capture(decomposer: Decomposer, astronaut: np.ndarray) -> None:
    linear = replace(ANY_CAMERA, tone=None, linear_capture=None)
    found = decomposer(astronaut, detail=False, capture=linear)
    plain = decomposer(astronaut, detail=False, capture=linear.capture)
    np.testing.assert_array_equal(found.melanin, plain.melanin)
    assert found.capture_known == ("light", "temperature", "white_balance", "exposure")


def test_the_tone_curve_is_undone(decomposer: Decomposer, astronaut: np.ndarray) -> None:
    found = decomposer(astronaut, detail=False, capture=ANY_CAMERA)
    picture, capture = ANY_CAMERA.linearise(read_picture(astronaut))
    straight = decomposer(picture, detail=False, capture=capture)
    np.testing.assert_array_equal(found.melanin, straight.melanin)
    assert "linear" in found.capture_known
    outside = np.ones(astronaut.shape[:2], bool)
    outside[found.box.slices] = False
    assert (found.reconstruction == astronaut)[outside].all()
    restored = FULL.restore(straight.reconstruction[found.box.slices])
    skin = found.mask[found.box.slices] > 0.5
    apart = np.abs(restored[skin].astype(int) - found.reconstruction[found.box.slices][skin])
    assert np.median(apart) == 0


def test_edits_take_the_photograph_as_it_is(decomposer: Decomposer, astronaut: np.ndarray) -> None:
    plain = decomposer.edit(astronaut, melanin=2.0, capture=ANY_CAMERA.capture)
    found = decomposer.edit(astronaut, melanin=2.0, capture=ANY_CAMERA)
    np.testing.assert_array_equal(found, plain)


@pytest.mark.slow
def test_a_profile_from_another_light_is_noticed(astronaut: np.ndarray) -> None:
    shipped = Decomposer(threads=1)
    noted = shipped(astronaut, detail=False, capture=WARM).notes
    assert any("lamp.jpg) seems to be from another light" in note for note in noted)
    fitting = CaptureProfile(Capture(white_balance=(0.0, 0.0)))
    assert shipped(astronaut, detail=False, capture=fitting).notes == ()


def test_a_reference_in_the_picture_is_compared() -> None:
    photo = np.full((60, 60, 3), 150, np.uint8)
    picture = read_picture(photo)
    profile, notes = WARM.adopt_white(picture, (30, 30), 0.4)
    assert len(notes) == 1 and "is from another light or white balance" in notes[0]
    assert profile.white_balance == pytest.approx((0, 0), abs=0.01)
    assert profile.light == WARM.light
    _, notes = CaptureProfile(Capture(white_balance=(0.05, 0.0))).adopt_white(picture, (30, 30))
    assert notes == ()
    both, _ = FULL.adopt_white(picture, (30, 30), 0.4)
    assert both.linear_capture is not None and both.linear_capture.linear
    assert both.linear_capture.exposure != both.capture.exposure


def shoot(path: Path, model: str, time: float) -> Path:
    exif = Image.Exif()
    exif[0x0110] = model
    exif.get_ifd(0x8769).update({0x829A: time, 0x829D: 2.8, 0x8827: 200})
    Image.new("RGB", (40, 40), (150, 140, 130)).save(path, exif=exif)
    return path


def test_other_cameras_and_exposures_are_noticed(tmp_path: Path) -> None:
    profile = CaptureProfile.from_white(shoot(tmp_path / "a.jpg", "X100", 0.01), (20, 20), 0.18)
    assert profile.settings.camera == "X100" and profile.exposure is not None
    same, notes = profile.fit_to(read_picture(shoot(tmp_path / "b.jpg", "X100", 0.01)))
    assert same == profile and notes == ()
    other, notes = profile.fit_to(read_picture(shoot(tmp_path / "c.jpg", "D700", 0.02)))
    assert other.exposure is None and len(notes) == 2
    assert "c.jpg is from a D700 and the capture profile from a X100" in notes[0]
    raw = replace(profile, format="RAW")
    with pytest.raises(InputError, match="made from a RAW file"):
        raw.fit_to(read_picture(tmp_path / "b.jpg"))
