"""The cost of building and measuring the statistical models, on synthetic people.

`python -m benchmarks.appearance [--json]`. 25 people at 1024 x 1024: both models from a stack on
disk (`pca_s`), then their measures, which fit no model again. Memory is the resident peak of a
separate process, which includes torch (Linux only).
"""

import json
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import torch
import torch.nn.functional as F
from jaxtyping import Float

from benchmarks.report import Results, main
from benchmarks.resources import read_resident_kb
from skinnet.appearance import (
    HybridModel,
    LinearModel,
    SkinColour,
    SkinTexture,
    SubjectStack,
    measure,
    open_stack,
    write_stack,
)

PEOPLE, SIZE = 25, 1024
MANY, SMALL = 200, 512
"""More people at a smaller size, for the growth of memory."""

FACE = 0.45
"""Half the width of the round face in a texture of width 1."""


def make_person(size: int, seed: int) -> SkinTexture:
    """Make smooth maps in the range of skin: levels, regions, spots and small offsets."""
    rng = np.random.default_rng(seed)
    level = rng.standard_normal(2)
    f_mel = 0.05 * np.exp(0.7 * level[0] + _sample_noise(rng, size, {3: 0.25, 9: 0.15, 65: 0.05}))
    f_blood = 0.045 * np.exp(
        0.2 * level[1] + _sample_noise(rng, size, {4: 0.25, 11: 0.15, 65: 0.05})
    )
    offset = np.stack([_sample_noise(rng, size, {5: 0.004, 33: 0.002}) for _ in range(3)], -1)
    axis = (np.arange(size) + 0.5) / size - 0.5
    face = np.hypot(axis[:, None], axis) < FACE
    maps = (values.astype(np.float32) for values in (f_mel.clip(0, 1), f_blood.clip(0, 1), offset))
    return SkinTexture(*maps, face, f"person {seed}")


def _sample_noise(
    rng: np.random.Generator, size: int, nodes: dict[int, float]
) -> Float[np.ndarray, "size size"]:
    """Sum cubic surfaces through normal numbers on grids of so many nodes a side."""
    total = np.zeros((size, size))
    for count, deviation in nodes.items():
        grid = torch.from_numpy(deviation * rng.standard_normal((1, 1, count, count)))
        total += F.interpolate(grid, (size, size), mode="bicubic", align_corners=True)[0, 0].numpy()
    return total


def write_people(folder: Path, count: int, size: int) -> SubjectStack:
    """Write a stack of people."""
    makers = {f"person {seed}": partial(make_person, size, seed) for seed in range(count)}
    return write_stack(folder, makers, SkinColour(), "synthetic people")


def measure_process(folder: str, measured: bool) -> Results:
    """Measure the seconds of each step on a stack, and the resident peak of this process in GB."""
    stack = open_stack(Path(folder))
    seconds: dict[str, float] = {}
    hybrid = _time(seconds, "hybrid", lambda: HybridModel.fit(stack))
    linear = _time(seconds, "linear", lambda: LinearModel.fit(stack))
    peak = read_resident_kb("VmHWM") / 1024**2
    if measured:
        _time(seconds, "measure_hybrid", lambda: measure(hybrid, stack))
        _time(seconds, "measure_linear", lambda: measure(linear, stack))
    return {"seconds": seconds, "fit_peak_gb": peak, "peak_gb": read_resident_kb("VmHWM") / 1024**2}


def _time(seconds: dict[str, float], name: str, work: Callable[[], Any]) -> Any:
    start = time.perf_counter()
    result = work()
    seconds[name] = time.perf_counter() - start
    return result


def measure_separately(folder: Path, measured: bool) -> Results:
    """Run `measure_process` in a separate process, whose peak is its own."""
    code = (
        "import json; from benchmarks.appearance import measure_process; "
        f"print(json.dumps(measure_process({str(folder)!r}, {measured})))"
    )
    root = Path(__file__).parents[1]
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=root, capture_output=True, text=True, check=True
    )
    results: Results = json.loads(done.stdout)
    return results


def measure_costs(
    count: int = PEOPLE, size: int = SIZE, many: int = MANY, small: int = SMALL
) -> Results:
    """Measure every figure."""
    with tempfile.TemporaryDirectory() as folder:
        first, second = Path(folder, "first"), Path(folder, "second")
        start = time.perf_counter()
        write_people(first, count, size)
        written = time.perf_counter() - start
        few = measure_separately(first, measured=True)
        write_people(second, many, small)
        crowd = measure_separately(second, measured=False)
    return {
        "pca_s": few["seconds"]["hybrid"] + few["seconds"]["linear"],
        "fit_peak_gb": few["fit_peak_gb"],
        "peak_gb": few["peak_gb"],
        "write_s": written,
        "seconds": few["seconds"],
        "many": {"people": many, "size": small, **crowd},
    }


if __name__ == "__main__":
    main(measure_costs, "The cost of building and measuring the statistical models of appearance.")
