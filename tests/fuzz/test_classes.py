"""Damaged and hostile inputs of every class end with a result or a sentence, in bounds.

`make fuzz` tries many more; CONTRIBUTING.md says how a case is run again.
"""

import pytest
from hypothesis import Phase, given, settings
from hypothesis import strategies as st

from benchmarks.fuzzing import CLASSES
from benchmarks.fuzzing.runner import Runner

pytestmark = pytest.mark.slow

CASES = {
    "pictures": 150,
    "onnx": 30,
    "safetensors": 60,
    "checkpoints": 60,
    "npz": 100,
    "shape_models": 100,
    "meshes": 150,
    "landmarks": 150,
    "tables": 40,
    "settings": 60,
    "command_lines": 30,
}
"""Cases of each class; all of them take about a minute."""


def test_every_class_is_tried() -> None:
    assert CASES.keys() == CLASSES.keys()


@pytest.mark.parametrize("kind", CASES)
def test_a_result_or_a_sentence(kind: str, runner: Runner) -> None:
    @settings(max_examples=CASES[kind], phases=[Phase.generate])
    @given(st.integers(0, 2**32 - 1))
    def check(seed: int) -> None:
        outcome = runner.run(kind, seed)
        assert outcome.survived, outcome.describe()

    check()
