"""`skinnet sample`."""

import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from skinnet.appearance.maps_file import load_maps
from skinnet.cli import main

pytestmark = pytest.mark.slow

Refused = Callable[..., str]


def test_samples_are_skins_and_the_same_twice(model: Path, tmp_path: Path) -> None:
    command = ["sample", str(model / "hybrid.npz"), "-n", "3", "--seed", "5", "-o"]
    for folder in ("one", "two"):
        assert main([*command, str(tmp_path / folder)]) == 0
    for number in range(3):
        pair = [
            load_maps(tmp_path / folder / f"sample_{number:02}_maps.npz")[0]
            for folder in ("one", "two")
        ]
        np.testing.assert_array_equal(pair[0].f_mel, pair[1].f_mel)
        assert pair[0].f_mel[pair[0].mask].min() >= 0
    assert (tmp_path / "one" / "samples.png").is_file()


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["-n", "0"], "count is 1 or more"),
        (["--spread=-1"], "spread is a number of deviations"),
    ],
)
def test_bad_samples_are_refused(
    model: Path, refused: Refused, options: list[str], words: str
) -> None:
    assert words in refused("sample", model / "hybrid.npz", *options)


def test_a_linear_model_is_no_hybrid(model: Path, refused: Refused) -> None:
    said = refused("sample", model / "linear.npz")
    assert "is a LinearModel, and a HybridModel is needed" in said


def test_json_lists_what_was_made(
    model: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    command = ["sample", str(model / "hybrid.npz"), "-n", "2", "-o", str(tmp_path / "out")]
    assert main([*command, "--json", "--quiet"]) == 0
    out, err = capsys.readouterr()
    (line,) = out.splitlines()
    found = json.loads(line)
    assert (found["count"], found["seed"], found["spread"]) == (2, 0, 1.0) and err == ""
    assert {Path(file).name for file in found["files"]} == {
        file.name for file in (tmp_path / "out").iterdir()
    }
