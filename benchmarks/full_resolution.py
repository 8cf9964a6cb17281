"""Seconds and memory of a 12-megapixel portrait at full resolution, beside the network alone.

    python -m benchmarks.full_resolution [--json]

The portrait is scikit-image's astronaut, enlarged, with grain: `portrait` all of it, `close_up` a
crop that the head fills, of which all pixels are looked at. Each figure is from a process of its
own: the least seconds of two runs, model files open, and the highest resident memory.
`cpu_seconds` add up all threads; they say more than seconds do where other programs run.
`from_jpeg` begins with the file's decoding.
"""

import json
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
    """Seconds and MiB of each picture at full resolution, of the network alone, and their ratio."""
    with tempfile.TemporaryDirectory() as folder:
        return {name: _measured(Path(folder), name) for name in PICTURES}


def enlarged(name: str, seed: int = 0) -> NDArray[np.uint8]:
    """A picture of `PICTURES` with a grain of two levels of 8 bits, uint8 sRGB [H, W, 3]."""
    rows, columns, size = PICTURES[name]
    image = Image.fromarray(astronaut()[rows, columns])
    smooth = np.asarray(image.resize(size, Image.Resampling.BICUBIC), np.float32)
    grain = np.random.default_rng(seed).standard_normal(smooth.shape, np.float32)
    return np.rint(smooth + 2 * grain).clip(0, 255).astype(np.uint8)


def _measured(folder: Path, name: str) -> dict[str, Any]:
    photo = enlarged(name)
    np.save(folder / f"{name}.npy", photo)
    Image.fromarray(photo).save(folder / f"{name}.jpg", quality=92)
    full = _in_process(folder / f"{name}.npy", detail=True)
    soft = _in_process(folder / f"{name}.npy", detail=False)
    return {
        "megapixels": photo.shape[0] * photo.shape[1] / 1e6,
        "full_resolution": full,
        "from_jpeg": _in_process(folder / f"{name}.jpg", detail=True),
        "network_alone": soft,
        "ratio": full["cpu_seconds"] / soft["cpu_seconds"],
    }


def _in_process(path: Path, detail: bool) -> dict[str, float]:
    command = [sys.executable, "-m", __spec__.name, str(path), str(int(detail))]
    done = subprocess.run(command, check=True, capture_output=True, text=True)
    found: dict[str, float] = json.loads(done.stdout)
    return found


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
