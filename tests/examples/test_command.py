"""Examples refuse bad arguments in a sentence and replace no file of others."""

from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from examples import figures, lightstage, london, scans, strip, synthetic, tones
from examples._command import check_picture, write_picture
from skinnet.errors import InputError

Main = Callable[[Sequence[str]], int]


@pytest.mark.parametrize(
    ("main", "arguments", "words"),
    [
        (tones.main, ["--size", "0"], "size is a number from 16 to 8192; got 0"),
        (tones.main, ["--size", "-5"], "size is a number from 16"),
        (tones.main, ["--texels", "0"], "texels is a number from 4"),
        (tones.main, ["-o", "x.txt"], "x.txt does not end in .png"),
        (tones.main, ["-o", "."], "does not end in .png"),
        (strip.main, ["--size", "5"], "size is a number from 96"),
        (figures.main, ["4"], "Figures 2, 3, 6, 7 and 8 are recomputed; got 4"),
        (figures.main, ["--dpi", "1"], "dpi is a number from 20"),
        (synthetic.main, ["-o", "x.jpg"], "x.jpg does not end in .png"),
        (synthetic.main, ["--beside", "absent"], "absent is not a folder"),
        (lightstage.main, ["--people", "0"], "people is a number from 3"),
        (lightstage.main, ["--texels", "1"], "texels is a number from 16"),
        (london.main, ["absent"], "absent has 0 portraits with landmarks"),
        (scans.main, ["absent"], "head.obj cannot be read"),
    ],
)
def test_a_bad_argument_ends_in_a_sentence(
    main: Main,
    arguments: list[str],
    words: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(arguments) == 2
    assert words in capsys.readouterr().err
    assert not list(tmp_path.iterdir())


def test_every_example_has_tests() -> None:
    examples = Path(__file__).parents[2] / "examples"
    for script in examples.glob("[a-z]*.py"):
        assert (Path(__file__).parent / f"test_{script.name}").is_file(), script.name


def test_a_picture_replaces_only_one_of_the_same_example(tmp_path: Path) -> None:
    path, default = tmp_path / "a.png", tmp_path / "default.png"
    write_picture(path, np.zeros((2, 2, 3), np.uint8), "tones")
    check_picture(path, default, "tones")
    with pytest.raises(InputError, match="was not written by this example"):
        check_picture(path, default, "synthetic")
    Image.new("RGB", (2, 2)).save(path)
    with pytest.raises(InputError, match=r"a.png is there already"):
        check_picture(path, default, "tones")
    (tmp_path / "b.png").mkdir()
    with pytest.raises(InputError, match="is a folder"):
        check_picture(tmp_path / "b.png", default, "tones")


def test_people_of_other_numbers_are_not_taken(tmp_path: Path) -> None:
    scan, truth = tmp_path / "person_00.obj", tmp_path / "person_00_truth.npz"
    assert not lightstage.is_painted(scan, 25, 64)
    scan.write_text("v 0 0 0\n")
    with pytest.raises(InputError, match="was not painted for 25 people with 64 texels"):
        lightstage.is_painted(scan, 25, 64)
    np.savez(truth, numbers=np.array([25, 64]))
    assert lightstage.is_painted(scan, 25, 64)
    with pytest.raises(InputError, match="was not painted for 5 people"):
        lightstage.is_painted(scan, 5, 64)
