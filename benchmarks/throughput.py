"""Photographs a second of a folder: one process, one process a core, and a plain loop over files.

    python -m benchmarks.throughput [--json] [--photographs N] [--runs N] [--workers N]

The loop is what programs of this kind do: one photograph after another, with all cores for the
network. All three write the same files; `equal` says whether those of the workers are equal, byte
for byte, with the lines that are printed and the table. Runs take turns, and the fastest of each
counts. Processor time does not depend on what else runs on the machine.
"""

import contextlib
import json
import os
import resource
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from PIL import Image
from skimage.data import astronaut

from benchmarks.report import Results, main
from skinnet.inference._workers.pool import WAITING
from skinnet.inference._workers.worker_count import count_cores

SIZES = (512, 768, 1024)
"""Sides of the photographs, in turn, in pixels."""

LOOP = """
import sys
from pathlib import Path
from skinnet import Decomposer
from skinnet.images import read_photo
from skinnet.inference import write_results
decomposer = Decomposer()
for file in sorted(Path(sys.argv[1]).iterdir()):
    photo = read_photo(file)
    read = decomposer(photo, name=str(file))
    write_results(Path(sys.argv[2]), file.stem, photo, read, read.to_dict())
"""
"""A loop over the files of a folder, as one writes it first."""


def measure(photographs: int = 36, runs: int = 2, workers: int | None = None) -> Results:
    """Measure the three ways on the same photographs.

    Args:
        photographs: Their number.
        runs: Runs of each way; they take turns.
        workers: Number of processes; the number of cores by default.

    Returns:
        Photographs a second of each way with and without its start, their ratios, seconds of
        processor time a photograph, and the largest memory of all processes of a way together.
    """
    workers = workers or count_cores()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        _write_photographs(folder / "all", photographs)
        _write_photographs(folder / "few", len(SIZES))
        ways = {way: _make_command(way, workers) for way in ("loop", "one_worker", "workers")}
        timed: dict[str, list[dict[str, float]]] = {way: [] for way in ways}
        start: dict[str, list[float]] = {way: [] for way in ways}
        for _ in range(runs):
            for way, command in ways.items():
                timed[way].append(_run(command, folder / "all", folder / way))
                start[way].append(_run(command, folder / "few", folder / f"few_{way}")["wall_s"])
        best = {way: min(each, key=lambda one: one["wall_s"]) for way, each in timed.items()}
        equal = _read(folder / "one_worker") == _read(folder / "workers")
    return _summarise(best, start, timed, equal, photographs, workers)


def _summarise(
    best: dict[str, dict[str, float]],
    start: dict[str, list[float]],
    timed: dict[str, list[dict[str, float]]],
    equal: bool,
    photographs: int,
    workers: int,
) -> Results:
    rates = {way: photographs / each["wall_s"] for way, each in best.items()}
    more = photographs - len(SIZES)
    steady = {way: more / max(each["wall_s"] - min(start[way]), 1e-9) for way, each in best.items()}
    return {
        "equal": equal,
        "speedup": rates["workers"] / rates["one_worker"],
        "speedup_over_loop": rates["workers"] / rates["loop"],
        "speedup_without_start": steady["workers"] / steady["one_worker"],
        "photographs": photographs,
        "sides_px": list(SIZES),
        "cores": count_cores(),
        "workers": workers,
        "photographs_in_flight": workers,
        "photographs_that_wait": WAITING * workers,
        "load_average": os.getloadavg()[0],
        "images_per_s": rates,
        "images_per_s_without_start": steady,
        "cpu_s_per_image": {
            way: min(one["cpu_s"] for one in each) / photographs for way, each in timed.items()
        },
        "peak_mb": {way: max(one["peak_mb"] for one in each) for way, each in timed.items()},
    }


def _write_photographs(folder: Path, count: int) -> None:
    folder.mkdir()
    photo = Image.fromarray(astronaut())
    for number in range(count):
        side = SIZES[number % len(SIZES)]
        photo.resize((side, side)).save(folder / f"photo_{number:04d}.jpg", quality=92)


def _make_command(way: str, workers: int) -> list[str]:
    if way == "loop":
        return [sys.executable, "-c", LOOP, "{input}", "{output}"]
    count = workers if way == "workers" else 1
    predict = ["-m", "skinnet", "predict", "{input}", "-o", "{output}", "--json"]
    return [sys.executable, *predict, "--csv", "{output}.csv", "--workers", str(count)]


def _run(command: list[str], photographs: Path, output: Path) -> dict[str, float]:
    """Run a command on a folder. Returns its seconds, those of the processors, and its memory."""
    words = [word.format(input=photographs, output=output) for word in command]
    output.with_name(f"{output.name}.csv").unlink(missing_ok=True)
    before, started = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
    with output.with_name(f"{output.name}.txt").open("wb") as lines:
        process = subprocess.Popen(words, stdout=lines, stderr=subprocess.PIPE)
        with _watch_memory(process.pid) as peak:
            _, said = process.communicate()
    if process.returncode:
        raise RuntimeError(said.decode())
    wall, after = time.perf_counter() - started, resource.getrusage(resource.RUSAGE_CHILDREN)
    cpu = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return {"wall_s": wall, "cpu_s": cpu, "peak_mb": max(peak) / 1024}


@contextlib.contextmanager
def _watch_memory(process: int) -> Iterator[list[int]]:
    """Note the resident memory, in kB, of a process and its children, ten times a second; Linux."""
    seen, ended = [0], threading.Event()

    def watch() -> None:
        while not ended.wait(0.1):
            seen.append(sum(map(_read_resident_kb, [process, *_list_children(process)])))

    thread = threading.Thread(target=watch)
    thread.start()
    try:
        yield seen
    finally:
        ended.set()
        thread.join()


def _list_children(process: int) -> list[int]:
    found: list[int] = []
    with contextlib.suppress(OSError):
        for file in Path(f"/proc/{process}/task").glob("*/children"):
            found += map(int, file.read_text(encoding="ascii").split())
    return found


def _read_resident_kb(process: int) -> int:
    with contextlib.suppress(OSError):
        for line in Path(f"/proc/{process}/status").read_text(encoding="utf-8").splitlines():
            if line.startswith("VmRSS"):
                return int(line.split()[1])
    return 0


def _read(output: Path) -> Any:
    """All that a run has written: its files, its lines and its table."""
    files = {file.name: file.read_bytes() for file in output.iterdir()}
    lines = output.with_name(f"{output.name}.txt").read_text(encoding="utf-8").splitlines()
    return files, [json.loads(line) for line in lines], output.with_suffix(".csv").read_bytes()


if __name__ == "__main__":
    main(
        measure,
        __doc__ or "",
        counts={
            "photographs": "their number (36)",
            "runs": "runs of each way (2)",
            "workers": "processes (one for each core)",
        },
    )
