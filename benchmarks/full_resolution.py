"""Seconds and memory of a 12-megapixel portrait at full resolution, beside the network alone.

    python -m benchmarks.full_resolution [--json]

The photographs are scikit-image's astronaut, enlarged, with grain: `portrait` is all of it, and
`close_up` a crop that the head fills, of which all pixels are decomposed. Each figure comes from
its own process: the shorter of two runs with loaded models, and the highest resident memory.
`cpu_seconds` are the sum over threads, which other programs disturb less than seconds. `from_jpeg`
includes the decoding of the file; `command` is `skinnet predict`, once, from its start until all
files are written.
"""

import json
import os
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image
from skimage.data import astronaut

from benchmarks.report import main

RUNS = 2
PICTURES = {
    "portrait": (slice(0, 512), slice(0, 512), (3464, 3464)),
    "close_up": (slice(0, 222), slice(75, 371), (4000, 3000)),
}
"""Rows and columns of the astronaut, and the width and height that they are enlarged to."""


def measure() -> dict[str, Any]:
    """Measure each picture at full resolution and with the network alone, and their ratio."""
    with tempfile.TemporaryDirectory() as folder:
        return {name: _measure_picture(Path(folder), name) for name in PICTURES}


def enlarge_astronaut(name: str, seed: int = 0) -> NDArray[np.uint8]:
    """Enlarge to a picture of `PICTURES`, uint8 sRGB [H, W, 3], with noise of 2 levels (SD)."""
    rows, columns, size = PICTURES[name]
    image = Image.fromarray(astronaut()[rows, columns])
    smooth = np.asarray(image.resize(size, Image.Resampling.BICUBIC), np.float32)
    grain = np.random.default_rng(seed).standard_normal(smooth.shape, np.float32)
    return np.rint(smooth + 2 * grain).clip(0, 255).astype(np.uint8)


def _measure_picture(folder: Path, name: str) -> dict[str, Any]:
    photo = enlarge_astronaut(name)
    np.save(folder / f"{name}.npy", photo)
    Image.fromarray(photo).save(folder / f"{name}.jpg", quality=92)
    full = _run_process(folder / f"{name}.npy", detail=True)
    soft = _run_process(folder / f"{name}.npy", detail=False)
    return {
        "megapixels": photo.shape[0] * photo.shape[1] / 1e6,
        "full_resolution": full,
        "from_jpeg": _run_process(folder / f"{name}.jpg", detail=True),
        "network_alone": soft,
        "command": _run_command(folder / f"{name}.jpg"),
        "ratio": full["cpu_seconds"] / soft["cpu_seconds"],
    }


def _run_process(path: Path, detail: bool) -> dict[str, float]:
    command = [sys.executable, "-m", __spec__.name, str(path), str(int(detail))]
    done = subprocess.run(command, check=True, capture_output=True, text=True)
    figures: dict[str, float] = json.loads(done.stdout)
    return figures


def _run_command(path: Path) -> dict[str, float]:
    """Run `skinnet predict` from start to end, with all files that it writes."""
    region = "skin" if path.stem == "close_up" else "face"
    command = [sys.executable, "-m", "skinnet", "predict", str(path), "--region", region]
    started = time.perf_counter()
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode:
        raise RuntimeError(f"{' '.join(command)} ended with {process.returncode}.")
    return {
        "seconds": time.perf_counter() - started,
        "cpu_seconds": usage.ru_utime + usage.ru_stime,
        "peak_mib": usage.ru_maxrss / 1024,
    }


def _decompose(path: Path, detail: bool) -> dict[str, float]:
    from skinnet import Decomposer

    decomposer = Decomposer()
    decomposer.load()
    image = np.load(path) if path.suffix == ".npy" else path
    seconds, cpu = [], []
    for _ in range(RUNS):
        started, busy = time.perf_counter(), time.process_time()
        decomposer(image, whole_image=path.stem == "close_up", detail=detail)
        seconds.append(time.perf_counter() - started)
        cpu.append(time.process_time() - busy)
    kib = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return {"seconds": min(seconds), "cpu_seconds": min(cpu), "peak_mib": kib / 1024}


if __name__ == "__main__":
    if len(sys.argv) == 3:
        print(json.dumps(_decompose(Path(sys.argv[1]), sys.argv[2] == "1")))
    else:
        main(measure, __doc__ or "")
