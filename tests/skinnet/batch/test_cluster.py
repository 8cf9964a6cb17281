"""On two machines in one, processes and a machine die, and each photograph is there once."""

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from batch_files import list_parts, read_rows
from PIL import Image
from skimage.data import astronaut

from skinnet.batch import flatten_summary
from skinnet.inference import Decomposer

pytest.importorskip("ray", reason="Ray is not installed")
pytestmark = pytest.mark.slow

ROOT = Path(__file__).parents[3]
PHOTOGRAPHS, BLOCK, SECONDS = 24, 2, 600


def start(arguments: list[object], **options: Any) -> "subprocess.Popen[str]":
    """Start Python, which finds the package where the tests find it."""
    environment = os.environ | {"PYTHONPATH": str(ROOT), "RAY_USAGE_STATS_ENABLED": "0"}
    environment.pop("RAY_ADDRESS", None)
    command = [sys.executable, *(str(each) for each in arguments)]
    return subprocess.Popen(command, env=environment, text=True, **options)


@pytest.fixture(scope="module")
def cluster() -> Iterator[dict[str, Any]]:
    """The cluster: its address, the processes of its machines, and what ends one."""
    pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE}
    process = start([ROOT / "tests" / "batch_cluster.py"], **pipes)
    assert process.stdin is not None and process.stdout is not None
    found: dict[str, Any] = json.loads(process.stdout.readline())

    def end(machine: int) -> None:
        process.stdin.write(f"end {machine}\n")
        process.stdin.flush()
        assert process.stdout.readline() == f"end {machine}\n"

    yield found | {"end": end}
    process.communicate(timeout=60)


@pytest.fixture(scope="module")
def photos(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Small photographs of a face in many exposures, and a file that is none."""
    folder = tmp_path_factory.mktemp("photos")
    face = astronaut()[:224, 108:332]
    for number in range(PHOTOGRAPHS):
        exposed = np.clip(face * (0.7 + 0.015 * number), 0, 255).astype(np.uint8)
        Image.fromarray(exposed).save(folder / f"{number:02}.png")
    (folder / "damaged.jpg").write_bytes(b"\xff\xd8\xff damaged")
    return folder


def read(photos: Path, output: Path, address: str) -> "subprocess.Popen[str]":
    arguments = ["-m", "skinnet.batch", photos, output, "--block", BLOCK, "--address", address]
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE}
    return start([*arguments, "--json", "--no-detail"], **pipes)


def wait_for_parts(output: Path, count: int, process: "subprocess.Popen[str]") -> None:
    """Wait until some parts are written; the run must still go on then."""
    end = time.monotonic() + SECONDS
    while len(list_parts(output)) < count:
        assert process.poll() is None and time.monotonic() < end, process.communicate()[1]
        time.sleep(0.05)


def list_workers(machine: int) -> list[int]:
    """Processes that read photographs on a machine, by the process of that machine."""
    found = []
    for folder in Path("/proc").glob("[0-9]*"):
        try:
            parent = int((folder / "stat").read_text().rpartition(")")[2].split()[1])
            name = (folder / "cmdline").read_text()
        except OSError:  # it has ended meanwhile
            continue
        if parent == machine and "MapWorker" in name:
            found.append(int(folder.name))
    return found


def check(process: "subprocess.Popen[str]", output: Path, expected: dict[str, Any]) -> None:
    """Each photograph is there once, with the numbers of a `Decomposer`, and the failure too."""
    out, err = process.communicate(timeout=SECONDS)
    assert process.returncode == 2, err
    assert "Traceback" not in err and "damaged.jpg" in err
    counts = json.loads(out)
    assert (counts["read"], counts["failed"], counts["rows"]) == (PHOTOGRAPHS, 1, PHOTOGRAPHS + 1)
    rows = read_rows(output)
    assert [Path(row["file"]).name for row in rows] == [*sorted(expected), "damaged.jpg"]
    for row in rows[:-1]:
        numbers = expected[Path(row["file"]).name]
        assert {name: row[name] for name in numbers} == numbers


@pytest.fixture(scope="module")
def expected(photos: Path) -> dict[str, Any]:
    """The rows that a `Decomposer` gives, bit for bit."""
    decomposer = Decomposer(threads=1)
    return {
        path.name: flatten_summary(decomposer(path, detail=False).summary())
        for path in sorted(photos.glob("*.png"))
    }


@pytest.mark.skipif(sys.platform != "linux", reason="It lists processes as Linux does")
def test_each_photograph_is_there_once_whatever_dies(
    cluster: dict[str, Any], photos: Path, expected: dict[str, Any], tmp_path: Path
) -> None:
    end: Callable[[int], None] = cluster["end"]
    output, first = tmp_path / "out", cluster["processes"][0]
    run = read(photos, output, cluster["address"])
    wait_for_parts(output, 2, run)
    run.kill()  # the command itself; the same command goes on
    run.communicate()
    run = read(photos, output, cluster["address"])
    wait_for_parts(output, len(list_parts(output)) + 1, run)
    for worker in list_workers(first):
        os.kill(worker, signal.SIGKILL)
    wait_for_parts(output, len(list_parts(output)) + 2, run)
    end(1)
    check(run, output, expected)
