"""A RAW file tells its camera and that it is linear; names and EXIF tell more."""

import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from raw_files import photograph_picture

from skinnet import Decomposer
from skinnet.cli import main
from skinnet.errors import InputError
from skinnet.images import read_picture, srgb_to_linear
from skinnet.images._raw.cameras import find_camera
from skinnet.inference import Capture
from tools.dng import Sensor, write_dng

pytest.importorskip("rawpy")

NIKON, SONY = (find_camera(name).coefficients for name in ("Nikon D700", "Sony ILCE-7M3"))


@pytest.fixture(scope="module")
def shipped() -> Decomposer:
    return Decomposer(threads=1)


@pytest.fixture(scope="module")
def raw_file(tmp_path_factory: pytest.TempPathFactory, astronaut: np.ndarray) -> Path:
    path = tmp_path_factory.mktemp("raw") / "astronaut.dng"
    path.write_bytes(photograph_picture(srgb_to_linear(astronaut), "Nikon D700"))
    return path


@pytest.fixture(scope="module")
def jpeg_file(tmp_path_factory: pytest.TempPathFactory, astronaut: np.ndarray) -> Path:
    path = tmp_path_factory.mktemp("jpeg") / "a.jpg"
    exif = Image.Exif()
    exif[0x010F], exif[0x0110] = "SONY", "ILCE-7M3"
    exif.get_ifd(0x8769)[0x9209] = 1
    Image.fromarray(astronaut).save(path, quality=95, exif=exif)
    return path


def test_a_face_is_read_as_the_network_is_trained(
    shipped: Decomposer, raw_file: Path, astronaut: np.ndarray
) -> None:
    read = shipped(raw_file, detail=False)
    assert read.capture_known == ("camera", "linear")
    assert read.exif == {
        **{"camera": "NIKON D700", "flash": None, "white_balance": None, "light_source": None}
    }
    assert read.summary()["exif"] == read.exif
    told = shipped(astronaut, detail=False, capture=Capture(camera=NIKON, linear=True))
    assert read.means == pytest.approx(told.means, rel=0.08)


def test_what_is_given_comes_first(shipped: Decomposer, raw_file: Path) -> None:
    given = Capture(camera=SONY, linear=False, temperature=5500, light={"D": 1})
    read = shipped(raw_file, detail=False, capture=given)
    assert read.capture_known == ("light", "temperature", "camera", "linear")
    assert read.notes[0].endswith("is from a NIKON D700 by its EXIF, and another camera was given.")
    own = shipped(read_picture(raw_file), detail=False, capture=Capture(camera=NIKON))
    assert not any("another camera" in note for note in own.notes)


def test_a_raw_file_can_be_edited(shipped: Decomposer, raw_file: Path, tmp_path: Path) -> None:
    edited = shipped.edit_picture(read_picture(raw_file), melanin=2.0)
    assert edited.pixels.dtype == np.uint16
    out = tmp_path / "edited.png"
    assert main(["edit", str(raw_file), "--melanin", "2", "-o", str(out)]) == 0
    assert read_picture(out).pixels.shape == (512, 512, 3)


def test_an_edit_of_a_raw_file_is_a_png_by_default(
    raw_file: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["edit", str(raw_file), "--melanin", "2"]) == 0
    assert "is written as PNG, since RAW files are only read." in capsys.readouterr().err
    assert raw_file.with_name("astronaut_edited.png").is_file()


def test_captures_of_photographs(raw_file: Path, jpeg_file: Path, astronaut: np.ndarray) -> None:
    assert Capture.from_photograph(raw_file) == Capture(camera=NIKON, linear=True)
    assert Capture.from_photograph(str(jpeg_file)) == Capture(camera=SONY)
    assert Capture.from_photograph(Image.open(jpeg_file)) == Capture(camera=SONY)
    assert Capture.from_photograph(astronaut) == Capture()


def test_names_of_cameras_and_lights() -> None:
    assert Capture.from_names("sony a7 iii", "flash") == Capture({"D": 1.0}, 5500.0, SONY)
    assert Capture.from_names() == Capture()
    with pytest.raises(InputError, match=r"The camera 'Nikon D701' is not .* Nikon D700"):
        Capture.from_names("Nikon D701")


def test_exif_of_a_jpeg_is_only_recorded(shipped: Decomposer, jpeg_file: Path) -> None:
    read = shipped(jpeg_file, detail=False)
    assert read.capture_known == ()
    assert read.exif["camera"] == "SONY ILCE-7M3" and read.exif["flash"] is True


Run = Callable[..., tuple[int, dict, str]]


@pytest.fixture
def predict(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> Run:
    def run(*arguments: object) -> tuple[int, dict, str]:
        words = ["predict", "--json", "--no-detail", "-o", tmp_path, *arguments]
        code = main([str(word) for word in words])
        out, err = capsys.readouterr()
        return code, json.loads(out) if out else {}, err

    return run


def test_the_command_takes_names(predict: Run, raw_file: Path, jpeg_file: Path) -> None:
    code, summary, _ = predict(raw_file, "--light", "D65")
    assert code == 0
    assert summary["capture_known"] == ["light", "temperature", "camera", "linear"]
    assert summary["colour_space"]["known_from"] == "RAW development"
    _, summary, err = predict(jpeg_file, "--camera", "nikon d700", "--light", "fl2")
    assert summary["capture_known"] == ["light", "camera"]
    assert "is from a SONY ILCE-7M3 by its EXIF, and another camera was given." in err


def test_the_command_takes_the_camera_of_exif(
    predict: Run, jpeg_file: Path, tmp_path: Path, astronaut: np.ndarray
) -> None:
    _, summary, err = predict(jpeg_file, "--camera", "exif")
    assert summary["capture_known"] == ["camera"] and err == ""
    Image.fromarray(astronaut).save(tmp_path / "b.png")
    code, summary, err = predict(tmp_path / "b.png", "--camera", "exif")
    assert code == 0 and summary["capture_known"] == []
    assert "b.png: EXIF names no camera whose sensitivities are measured" in err


@pytest.mark.parametrize(
    ("flag", "value", "words"),
    [
        ("--camera", "Nikon D701", "nearest names are"),
        ("--light", "FL3", "There is no light of the name 'FL3'; FL"),
        ("--light", "D2000K", "Daylight has 4,000 to 25,000 K"),
    ],
)
def test_the_command_refuses_other_names(
    predict: Run, jpeg_file: Path, flag: str, value: str, words: str, tmp_path: Path
) -> None:
    code, summary, err = predict(jpeg_file, flag, value)
    (line,) = err.splitlines()
    assert code == 2 and summary == {} and words in line
    assert list(tmp_path.iterdir()) == []


def test_a_damaged_raw_file_does_not_stop_the_rest(
    predict: Run, jpeg_file: Path, tmp_path: Path
) -> None:
    (tmp_path / "cut.dng").write_bytes(write_dng(np.zeros((64, 96, 3)), Sensor())[:3000])
    code, summary, err = predict(tmp_path / "cut.dng", jpeg_file)
    assert code == 2 and summary["file"] == str(jpeg_file)
    assert "cut.dng is a RAW file that is damaged or cut short" in err
