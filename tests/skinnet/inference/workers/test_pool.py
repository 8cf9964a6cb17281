"""Processes do the photographs of a run; what they make of them comes in order."""

import os
import signal
import subprocess
import sys
import time
from collections import Counter
from pathlib import Path

import pytest
from worker_jobs import Job

from skinnet.errors import InputError
from skinnet.images._walk import Found, Walk
from skinnet.inference._input_run import run_over
from skinnet.inference._messages import describe
from skinnet.inference._workers.pool import open_pool

pytestmark = pytest.mark.skipif(os.name != "posix", reason="signals and groups of POSIX")


def wait_for(folder: Path, count: int) -> list[int]:
    """Wait until workers have begun to write. Returns their numbers."""
    for _ in range(600):
        found = [int(text) for path in folder.iterdir() if (text := path.read_text())]
        if len(found) == count:
            return found
        time.sleep(0.1)
    raise AssertionError("The workers have not begun.")


def wait_until_empty(folder: Path) -> None:
    for _ in range(600):
        if not [*folder.iterdir()]:
            return
        time.sleep(0.1)
    raise AssertionError("Something half written is left.")


def test_outcomes_come_in_order_and_a_process_that_dies_costs_its_photograph_alone(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    absent = Found("absent", InputError("There is no file absent."))
    names = ["slow.jpg", "slow.png", "slow-2.jpg", "a", "bad", "die", "wall", "b"]
    found, taken, failed = Walk([*map(Found, names), absent]), [], []

    def take(name: str) -> int:
        taken.append(name)
        return 2

    totals = run_over(
        *(found, Job(tmp_path), lambda name, error: failed.append((name, describe(error)))),
        quiet=True,
        take=take,
        workers=2,
    )
    assert taken == ["slow", "slow", "slow-2", "a", "b"]
    assert (totals.photographs, totals.faces) == (5, 10)
    assert totals.failures == Counter({"could not be read": 3, "without a face": 1})
    died = (
        "die is not done, since the process that had it has ended: it was killed, as the system "
        "does where memory runs out. Do it again with --workers 1; if that fails too, make the "
        "photograph smaller."
    )
    assert failed == [
        ("bad", "bad is damaged."),
        ("die", died),
        ("wall", "No face in wall."),
        ("absent", "There is no file absent."),
    ]
    out, err = capsys.readouterr()
    assert out.splitlines() == [f"{name} is done." for name in taken]
    seen = ["slow", "slow", "slow-2", "a", "bad", "wall", "b"]
    assert err.splitlines() == [f"skinnet: {name} is looked at." for name in seen]
    order = (tmp_path / "order.txt").read_text().splitlines()
    assert [name for name in order if name.startswith("slow")] == names[:3]


def test_other_errors_and_ctrl_c_end_the_workers_and_leave_nothing(tmp_path: Path) -> None:
    with (
        pytest.raises(ZeroDivisionError, match="fault"),
        open_pool(Job(tmp_path), [Found("fault"), Found("wait")], 2, False) as get,
    ):
        get(0).replay()
    assert [*tmp_path.iterdir()] == []
    workers: list[int] = []

    def interrupt() -> None:
        with open_pool(Job(tmp_path), [Found("wait")] * 2, 2, True):
            workers.extend(wait_for(tmp_path, 2))
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        interrupt()
    assert [*tmp_path.iterdir()] == []
    for worker in workers:
        with pytest.raises(ProcessLookupError):
            os.kill(worker, 0)


def test_workers_end_where_the_command_is_killed(tmp_path: Path) -> None:
    code = (
        "from pathlib import Path\n"
        "from skinnet.images._walk import Found\n"
        "from skinnet.inference._workers.pool import open_pool\n"
        "from worker_jobs import Job\n"
        f"with open_pool(Job(Path({str(tmp_path)!r})), [Found('wait')], 1, False) as get:\n"
        "    get(0)\n"
    )
    path = os.pathsep.join(each or os.getcwd() for each in sys.path)
    command = subprocess.Popen([sys.executable, "-c", code], env={**os.environ, "PYTHONPATH": path})
    wait_for(tmp_path, 1)
    command.send_signal(signal.SIGKILL)
    command.wait()
    wait_until_empty(tmp_path)


def test_workers_that_do_not_start_end_the_run(
    tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    folder = tmp_path / "broken"
    folder.mkdir()
    with pytest.raises(InputError, match=r"does not start: it ended with code 1\. Give --workers"):
        run_over(Walk([Found("a"), Found("b")]), Job(folder), lambda *_: None, workers=1 + 1)
    assert "The model is damaged." in capfd.readouterr().err
