"""What counts as a fault, and that a process that is lost is started again."""

import json
import os
import sys
import warnings
from collections.abc import Callable
from pathlib import Path

import pytest

from benchmarks.faults import main, measure
from benchmarks.fuzzing.case import Case, make_case
from benchmarks.fuzzing.runner import Runner
from benchmarks.fuzzing.worker import run_case
from skinnet.errors import InputError

ANSWER = json.dumps({"end": "result", "message": "", "seconds": 0.1, "peak_gb": 0.1})


def refuse(sentence: str) -> Callable[[Path], None]:
    def run(folder: Path) -> None:
        raise InputError(sentence)

    return run


@pytest.mark.parametrize(
    ("run", "message"),
    [
        (lambda folder: 1 / 0, "ZeroDivisionError"),
        (lambda folder: sys.exit(2), "SystemExit"),
        (lambda folder: warnings.warn("odd", stacklevel=1), "a warning: UserWarning: odd"),
        (lambda folder: os.write(2, b"libtiff: odd"), "printed by a library: libtiff: odd"),
        (lambda folder: print("odd"), "printed by a library: odd"),
        (refuse("x" * 3000), "a message of 3000 characters"),
        (refuse("a\nb\nc\nd\ne"), "a message of several lines"),
    ],
)
def test_faults(run: Callable[[Path], object], message: str) -> None:
    outcome = run_case(Case(run))
    assert outcome["end"] == "fault" and message in outcome["message"]


def test_a_sentence_and_a_result() -> None:
    assert run_case(Case(refuse("Give another file.")))["end"] == "sentence"
    read = Case(lambda folder: (folder / "a" / "b.txt").read_bytes(), {"a/b.txt": b"x"})
    outcome = run_case(read)
    assert outcome["end"] == "result" and outcome["peak_gb"] > 0


@pytest.mark.parametrize(
    ("program", "message"),
    [
        ("import sys; sys.exit(5)", "has crashed (exit code 5)"),
        ("import time; time.sleep(60)", "has not ended after 1 s"),
        ("import time; a = b'x' * 400_000_000; time.sleep(60)", "GB and more"),
        (f"while input(): print({ANSWER.replace('0.1', '7', 1)!r}, flush=True)", "it takes 7.0 s"),
        (
            f"while input(): print({ANSWER.replace('0.1}', '2.5}')!r}, flush=True)",
            "it takes 2.5 GB",
        ),
    ],
)
def test_a_process_that_is_lost(program: str, message: str) -> None:
    wait = 20.0 if "GB" in message else 1.0
    with Runner([sys.executable, "-c", program], wait, kill_gb=0.3) as runner:
        for seed in (1, 2):  # the second one has a new process
            outcome = runner.run("pictures", seed)
            assert not outcome.survived and message in outcome.message
            assert f"--only pictures --seed {seed} --cases 1" in outcome.describe()


@pytest.mark.parametrize("kind", ["landmarks", "meshes"])
def test_a_seed_makes_the_same_case(kind: str) -> None:
    for seed in range(5):
        assert make_case(kind, seed).files == make_case(kind, seed).files
    assert make_case(kind, 1).files != make_case(kind, 2).files


def test_figures_of_each_class(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["--only", "landmarks", "--cases", "3", "--seed", "7", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["tried"] == found["survived"] == 3 and found["landmarks"]["tried"] == 3
    assert {"slowest_seconds", "peak_gb", "results"} <= found["landmarks"].keys()


def test_a_budget_of_nothing_is_refused() -> None:
    for wrong in ({"only": "x"}, {"cases": 0}, {"minutes": -1.0}):
        with pytest.raises(InputError, match=r"There is no class x|more than nothing"):
            measure(**wrong)  # type: ignore[arg-type]
