from pathlib import Path

from benchmarks.files import count_cases

CASES = """
import pytest

@pytest.fixture
def broken():
    raise OSError

def test_right():
    pass

@pytest.mark.parametrize("value", [1, 2])
def test_wrong(value):
    assert value == 1

def test_set_up(broken):
    pass

def test_skipped():
    pytest.skip()
"""


def test_cases_are_counted_by_file(tmp_path: Path) -> None:
    (tmp_path / "test_some_kind.py").write_text(CASES)
    found = count_cases(tmp_path)
    assert (found["tried"], found["right"], found["share_right"]) == (4, 2, 0.5)
    assert found["kinds"] == {"some_kind": {"tried": 4, "right": 2}}
    assert len(found["wrong"]) == 2
