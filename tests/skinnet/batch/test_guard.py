"""What the command has started ends with it, even if it is killed."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from skinnet.batch._guard import end_together

linux = pytest.mark.skipif(sys.platform != "linux", reason="Processes are listed as on Linux.")


@linux
def test_a_kill_ends_the_children_of_children() -> None:
    sleeper = "import time; time.sleep(300)"
    code = (
        "import subprocess, sys, time\n"
        "from skinnet.batch._guard import end_together\n"
        "with end_together():\n"
        f"    child = subprocess.Popen([sys.executable, '-c', {sleeper!r}], "
        "stdout=subprocess.DEVNULL, start_new_session=True)\n"
        "    print(child.pid, flush=True)\n"
        "    time.sleep(300)\n"
    )
    command = subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, text=True)
    assert command.stdout is not None
    child = Path("/proc", command.stdout.readline().strip())
    assert child.exists()
    os.kill(command.pid, signal.SIGKILL)
    command.communicate()
    for _ in range(600):
        if not child.exists() or "\nState:\tZ" in (child / "status").read_text():
            return
        time.sleep(0.1)
    pytest.fail("the process of a killed command still runs")


@linux
def test_afterwards_nothing_is_left() -> None:
    before = dict(os.environ)
    with end_together():
        assert len(os.environ) == len(before) + 1
    assert dict(os.environ) == before
