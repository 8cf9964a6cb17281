"""The figures of the dynamic model on tracked clips."""

import json
from pathlib import Path

import pytest

from benchmarks import dynamic


@pytest.mark.slow
def test_a_flush_is_found_again(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    pytest.importorskip("av")
    words = ["--clips", "1", "--seconds", "3", "--size", "192", "--heads", "2", "--json"]
    assert dynamic.main([*words, "--geometry", str(tmp_path)]) == 0
    figures = json.loads(capsys.readouterr().out.splitlines()[-1])
    assert figures["clips"] + figures["not_tracked"] == 1
    assert {*figures["true"]["flush"]} == {*dynamic.PLACES}
    assert figures["true"]["held_out"]["r"] > 0.9
    for place in ("left cheek", "right cheek"):
        assert figures["true"]["flush"][place] > 0.5
        assert 0.2 < figures["tracked"]["flush"][place] < 2
