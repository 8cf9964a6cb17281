"""The command takes references and profiles, and refuses what is none with exit code 2."""

import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from skinnet.cli import main
from skinnet.inference import Capture, CaptureProfile

Refused = Callable[..., str]


@pytest.fixture
def photo(tmp_path: Path, astronaut: np.ndarray) -> Path:
    """A face with a grey card in the upper right corner."""
    pixels = astronaut[:256, 96:352].copy()
    pixels[:30, -30:] = (150, 140, 128)
    pixels[-30:, :30] = (180, 30, 20)
    Image.fromarray(pixels).save(tmp_path / "a.png")
    return tmp_path / "a.png"


def read_known(photo: Path, model_file: Path, *options: object) -> dict:
    arguments = ["predict", photo, "--no-detail", "--model", model_file, *options]
    assert main([str(each) for each in arguments]) == 0
    return json.loads((photo.parent / "skinmaps" / "a.json").read_text())


def test_white_is_known(photo: Path, model_file: Path) -> None:
    assert read_known(photo, model_file)["capture_known"] == []
    found = read_known(photo, model_file, "--white", "240,15")
    assert found["capture_known"] == ["white_balance"]
    found = read_known(photo, model_file, "--white", "230,4,252,26", "--white-colour", "0.18")
    assert found["capture_known"] == ["white_balance", "exposure"]


def test_a_profile_of_a_card_serves_all_pictures(
    photo: Path, model_file: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    target = photo.with_name("studio.yaml")
    made = ["capture", photo, "--white", "240,15", "--white-colour", "18%", "-o", target]
    assert main([str(each) for each in made]) == 0
    assert capsys.readouterr().out.endswith(f"log luminance of white 0.40; {target}\n")
    assert CaptureProfile.load(target).capture.exposure == pytest.approx(
        Capture.from_white((150, 140, 128), 0.18).exposure, abs=1e-3
    )
    found = read_known(photo, model_file, "--capture", target)
    assert found["capture_known"] == ["white_balance", "exposure"]
    edited = photo.with_name("e.png")
    arguments = ["edit", photo, "--melanin", 2, "--capture", target, "-o", edited]
    assert main([str(each) for each in (*arguments, "--model", model_file)]) == 0
    assert edited.is_file()
    assert main([str(each) for each in made]) == 0  # an older profile is replaced


@pytest.mark.parametrize(
    ("options", "sentence"),
    [
        (("--white", "900,3"), "900,3 is not in"),
        (("--white", "a"), "--white is a point X,Y or a box"),
        (("--white", "10,240"), "is coloured"),
        (("--white-colour", "0.18"), "give --white X,Y, too"),
        (("--white", "240,15", "--white-colour", "7"), "share in [0.01, 1]; got 7"),
        (("--white", "240,15", "--chart", "classic"), "leave out one"),
        (("--chart", "big"), "A chart is classic"),
        (("--capture", "absent.yaml"), "There is no capture profile absent.yaml"),
    ],
)
def test_what_cannot_be_used_is_refused(
    photo: Path, model_file: Path, refused: Refused, options: tuple[str, ...], sentence: str
) -> None:
    assert sentence in refused("predict", photo, "--model", model_file, *options)
    assert not (photo.parent / "skinmaps").exists()


def test_white_is_a_place_in_one_picture(photo: Path, model_file: Path, refused: Refused) -> None:
    options = "--model", model_file, "--white", "240,15"
    said = refused("predict", photo, photo.with_name("b.png"), *options)
    assert "2 are given. Make a profile of one of them with `skinnet capture`" in said


def test_pictures_are_no_profiles(photo: Path, model_file: Path, refused: Refused) -> None:
    said = refused("predict", photo, "--model", model_file, "--capture", photo)
    assert f"{photo} is not a capture profile" in said


def test_a_profile_replaces_no_other_file(photo: Path, refused: Refused) -> None:
    other = photo.with_name("notes.yaml")
    other.write_text("mine: 1\n")
    assert "is not a capture profile" in refused("capture", photo, "--white", "240,15", "-o", other)
    assert other.read_text() == "mine: 1\n"
    said = refused("capture", photo, "--white", "240,15", "-o", photo.with_name("a.json"))
    assert "is a .yaml file" in said


@pytest.mark.slow
def test_a_chart_makes_a_profile(
    chart_file: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    target = tmp_path / "studio.yml"
    assert main(["capture", str(chart_file), "-o", str(target)]) == 0
    said = capsys.readouterr()
    assert "CIEDE2000" in said.out and said.err == ""
    assert CaptureProfile.load(target) == CaptureProfile.from_chart(chart_file)


@pytest.mark.slow
def test_a_picture_without_a_chart_is_named(photo: Path, refused: Refused) -> None:
    said = refused("capture", photo, "-o", photo.with_name("studio.yaml"))
    assert f"No classic chart was found in {photo}" in said
    assert not photo.with_name("studio.yaml").exists()
