"""The structure of the package stays within its limits."""

import json

import pytest

from tools.house import PACKAGE, ROOT, main, measure, read_floors


def test_the_structure_stays_within_its_limits() -> None:
    found = measure(ROOT / PACKAGE, read_floors())
    assert found["entries"] <= 19
    assert found["public_definitions"] <= 150
    assert found["upward_imports"] == 0 and found["room_cycles"] == 0
    assert found["fully_annotated_share"] == 1
    assert found["docstring_share"] == 1


def test_it_prints_json(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["--json"]) == 0
    assert set(json.loads(capsys.readouterr().out)) >= {"entries", "median_file", "longest_file"}


@pytest.fixture
def package(tmp_path, monkeypatch):
    """Two rooms that import each other, one of them upwards."""
    upwards = "from skinnet.high.upper import shout\n\n\n"
    downwards = "from skinnet.low.lower import whisper\n\n\n"
    for room, source in {
        "low": upwards + "def whisper(text: str) -> str:\n    return shout(text)\n",
        "high": downwards + "def shout(text):\n    'Shout.'\n    return whisper(text)\n",
    }.items():
        (tmp_path / room).mkdir()
        (tmp_path / room / "__init__.py").write_text("")
        (tmp_path / room / ("lower.py" if room == "low" else "upper.py")).write_text(source)
    return tmp_path


def test_what_breaks_the_plan_is_counted(package) -> None:
    found = measure(package, {"low": 0, "high": 1})
    assert found["entries"] == 2 and found["public_definitions"] == 2
    assert found["upward_imports"] == 1 and found["room_cycles"] == 1
    assert found["fully_annotated_share"] == 0.5 and found["docstring_share"] == 0.5
