"""How long one photograph takes: the shipped encoder beside a BioFaceNet-shaped network, and the
command line.

    python -m benchmarks.latency [--json]

Milliseconds are the least of several runs in one process; the ratio is what counts.
"""

import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np
import onnxruntime
import torch
from PIL import Image
from skimage.data import astronaut

from benchmarks.biofacenet import BioFaceNetShape
from benchmarks.report import main
from export.onnx_file import quiet
from skinnet.inference import SHIPPED_ENCODER

RUNS = {256: 4, 512: 2}
"""Runs at each size, the first of which warms up."""
THREADS = (1, 2)


def measure() -> dict[str, Any]:
    """Times of both networks by size and threads, their ratios, and seconds of the commands."""
    with tempfile.TemporaryDirectory() as folder:
        rival = Path(folder) / "biofacenet.onnx"
        export_rival(rival)
        both = {"encoder": SHIPPED_ENCODER, "biofacenet": rival}
        times = {name: {str(size): {} for size in RUNS} for name in both}
        for size in RUNS:
            for threads in THREADS:
                for name, path in both.items():
                    times[name][str(size)][str(threads)] = run_ms(path, size, threads)
        ratios = {
            f"speedup_{size}": times["biofacenet"][str(size)]["1"]
            / times["encoder"][str(size)]["1"]
            for size in RUNS
        }
        return {**ratios, **{f"{name}_ms": value for name, value in times.items()}, **commands()}


def export_rival(path: Path) -> None:
    """Write the BioFaceNet-shaped network as ONNX, with free height and width."""
    torch.manual_seed(0)
    size = {2: torch.export.Dim("h") * 16, 3: torch.export.Dim("w") * 16}
    with quiet():
        program = torch.onnx.export(
            BioFaceNetShape().eval(),
            (torch.rand(1, 3, 256, 256),),
            dynamo=True,
            opset_version=20,
            dynamic_shapes=(size,),
            external_data=False,
            verbose=False,
        )
    assert program is not None
    program.save(path, external_data=False)


def run_ms(path: Path, size: int, threads: int) -> float:
    """The least time of one run on a noise photograph of that size."""
    options = onnxruntime.SessionOptions()
    options.intra_op_num_threads = threads
    session = onnxruntime.InferenceSession(path, options, providers=["CPUExecutionProvider"])
    entry = session.get_inputs()[0]
    lot = np.random.default_rng(0)
    feed = {entry.name: lot.integers(0, 256, (1, size, size, 3), np.uint8)}
    if "float" in entry.type:
        feed = {entry.name: lot.random((1, 3, size, size), np.float32)}
    return min(_timed(lambda: session.run(None, feed)) for _ in range(RUNS[size])) * 1e3


def commands() -> dict[str, float]:
    """Seconds of `skinnet --help` and of `skinnet predict` on one 512 x 512 photograph."""
    with tempfile.TemporaryDirectory() as folder:
        photograph = Path(folder) / "astronaut.png"
        Image.fromarray(astronaut()).save(photograph)
        predict = ["predict", str(photograph), "-o", folder]
        return {
            "cli_help_s": min(_timed(lambda: _command("--help")) for _ in range(5)),
            "cli_predict_s": min(_timed(lambda: _command(*predict)) for _ in range(3)),
        }


def _command(*arguments: str) -> None:
    command = [str(Path(sys.executable).with_name("skinnet")), *arguments]
    subprocess.run(command, check=True, capture_output=True)


def _timed(action: Any) -> float:
    started = time.perf_counter()
    action()
    return time.perf_counter() - started


if __name__ == "__main__":
    main(measure, __doc__ or "")
