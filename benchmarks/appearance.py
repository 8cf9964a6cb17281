"""What building and measuring the statistical models costs, on synthetic people.

`python -m benchmarks.appearance [--json]`. 25 people at 1024 x 1024: both models from a stack on
disk (`pca_s`), then their measures, none of which fits a model again. Each figure of memory is the
resident peak of a process of its own, torch and all (Linux only).
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
from skinnet.appearance.colour import SkinColour
from skinnet.appearance.hybrid import HybridModel
from skinnet.appearance.linear import LinearModel
from skinnet.appearance.measures import measure
from skinnet.appearance.skin_texture import SkinTexture
from skinnet.appearance.stack import SubjectStack, open_stack
from skinnet.appearance.stack_writer import write_stack

PEOPLE, SIZE = 25, 1024
MANY, SMALL = 200, 512
"""More people at a smaller size, for the growth of memory."""

FACE = 0.45
"""Half the width of the round face in a texture of width 1."""


def person(size: int, seed: int) -> SkinTexture:
    """Smooth maps in the range of skin: a level of each pigment, regions, spots, small offsets."""
    rng = np.random.default_rng(seed)
    level = rng.standard_normal(2)
    f_mel = 0.05 * np.exp(0.7 * level[0] + _noise(rng, size, {3: 0.25, 9: 0.15, 65: 0.05}))
    f_blood = 0.045 * np.exp(0.2 * level[1] + _noise(rng, size, {4: 0.25, 11: 0.15, 65: 0.05}))
    offset = np.stack([_noise(rng, size, {5: 0.004, 33: 0.002}) for _ in range(3)], -1)
    axis = (np.arange(size) + 0.5) / size - 0.5
    face = np.hypot(axis[:, None], axis) < FACE
    maps = (values.astype(np.float32) for values in (f_mel.clip(0, 1), f_blood.clip(0, 1), offset))
    return SkinTexture(*maps, face, f"person {seed}")


def _noise(
    rng: np.random.Generator, size: int, nodes: dict[int, float]
) -> Float[np.ndarray, "size size"]:
    """Sum of cubic surfaces through normal numbers on grids of so many nodes a side."""
    total = np.zeros((size, size))
    for count, deviation in nodes.items():
        grid = torch.from_numpy(deviation * rng.standard_normal((1, 1, count, count)))
        total += F.interpolate(grid, (size, size), mode="bicubic", align_corners=True)[0, 0].numpy()
    return total


def people(folder: Path, count: int, size: int) -> SubjectStack:
    """A stack of persons."""
    makers = {f"person {seed}": partial(person, size, seed) for seed in range(count)}
    return write_stack(folder, makers, SkinColour(), "synthetic people")


def study(folder: str, measured: bool) -> Results:
    """Seconds of each step on a stack, and this process' resident peak in GB."""
    stack = open_stack(Path(folder))
    seconds: dict[str, float] = {}
    hybrid = _timed(seconds, "hybrid", lambda: HybridModel.fit(stack))
    linear = _timed(seconds, "linear", lambda: LinearModel.fit(stack))
    peak = _peak()
    if measured:
        _timed(seconds, "measure_hybrid", lambda: measure(hybrid, stack))
        _timed(seconds, "measure_linear", lambda: measure(linear, stack))
    return {"seconds": seconds, "fit_peak_gb": peak, "peak_gb": _peak()}


def _timed(seconds: dict[str, float], name: str, work: Callable[[], Any]) -> Any:
    start = time.perf_counter()
    result = work()
    seconds[name] = time.perf_counter() - start
    return result


def _peak() -> float:
    lines = Path("/proc/self/status").read_text().splitlines()
    return next(int(line.split()[1]) for line in lines if line.startswith("VmHWM")) / 1024**2


def in_own_process(folder: Path, measured: bool) -> Results:
    """`study` where nothing else counts towards the peak."""
    code = (
        "import json; from benchmarks.appearance import study; "
        f"print(json.dumps(study({str(folder)!r}, {measured})))"
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
    """Every figure, by name."""
    with tempfile.TemporaryDirectory() as folder:
        first, second = Path(folder, "first"), Path(folder, "second")
        start = time.perf_counter()
        people(first, count, size)
        spooled = time.perf_counter() - start
        few = in_own_process(first, measured=True)
        people(second, many, small)
        crowd = in_own_process(second, measured=False)
    return {
        "pca_s": few["seconds"]["hybrid"] + few["seconds"]["linear"],
        "fit_peak_gb": few["fit_peak_gb"],
        "peak_gb": few["peak_gb"],
        "spool_s": spooled,
        "seconds": few["seconds"],
        "many": {"people": many, "size": small, **crowd},
    }


if __name__ == "__main__":
    main(measure_costs, "What the statistical models of appearance cost to build and to measure.")
