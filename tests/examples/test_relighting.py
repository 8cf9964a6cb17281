"""The relit faces: bad arguments end in a sentence."""

import pytest

from examples.relighting import main


def test_a_variant_that_mitsuba_does_not_have_is_refused(tmp_path, capsys) -> None:
    pytest.importorskip("mitsuba")
    assert main(["-o", str(tmp_path / "a.png"), "--variant", "fast"]) == 2
    assert "has no variant fast" in capsys.readouterr().err
