"""Time for one photograph: the shipped encoder, a network of BioFaceNet's shape, the command line.

    python -m benchmarks.latency [--json]

Milliseconds are the shortest of several runs in one process. The ratio matters, not the times.
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
from export.onnx_file import _silence_exporter
from skinnet.inference import SHIPPED_ENCODER

RUNS = {256: 4, 512: 2}
"""Runs at each size, the first of which warms up."""
THREADS = (1, 2)


def measure() -> dict[str, Any]:
    """Measure both networks by size and threads, their ratios, and the commands."""
    with tempfile.TemporaryDirectory() as folder:
        rival = Path(folder) / "biofacenet.onnx"
        export_rival(rival)
        both = {"encoder": SHIPPED_ENCODER, "biofacenet": rival}
        times = {name: {str(size): {} for size in RUNS} for name in both}
        for size in RUNS:
            for threads in THREADS:
                for name, path in both.items():
                    times[name][str(size)][str(threads)] = time_run_ms(path, size, threads)
        ratios = {
            f"speedup_{size}": times["biofacenet"][str(size)]["1"]
            / times["encoder"][str(size)]["1"]
            for size in RUNS
        }
        return {
            **ratios,
            **{f"{name}_ms": value for name, value in times.items()},
            **time_commands(),
        }


def export_rival(path: Path) -> None:
    """Write the BioFaceNet-shaped network as ONNX, with free height and width."""
    torch.manual_seed(0)
    size = {2: torch.export.Dim("h") * 16, 3: torch.export.Dim("w") * 16}
    with _silence_exporter():
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


def time_run_ms(path: Path, size: int, threads: int) -> float:
    """Measure the shortest time of one run on a photograph of noise, in milliseconds."""
    options = onnxruntime.SessionOptions()
    options.intra_op_num_threads = threads
    session = onnxruntime.InferenceSession(path, options, providers=["CPUExecutionProvider"])
    entry = session.get_inputs()[0]
    rng = np.random.default_rng(0)
    feed = {entry.name: rng.integers(0, 256, (1, size, size, 3), np.uint8)}
    if "float" in entry.type:
        feed = {entry.name: rng.random((1, 3, size, size), np.float32)}
    return min(_time(lambda: session.run(None, feed)) for _ in range(RUNS[size])) * 1e3


def time_commands() -> dict[str, float]:
    """Measure seconds of `skinnet --help` and of `skinnet predict` on one 512 x 512 photograph."""
    with tempfile.TemporaryDirectory() as folder:
        photograph = Path(folder) / "astronaut.png"
        Image.fromarray(astronaut()).save(photograph)
        predict = ["predict", str(photograph), "-o", folder]
        return {
            "cli_help_s": min(_time(lambda: _run_command("--help")) for _ in range(5)),
            "cli_predict_s": min(_time(lambda: _run_command(*predict)) for _ in range(3)),
        }


def _run_command(*arguments: str) -> None:
    command = [str(Path(sys.executable).with_name("skinnet")), *arguments]
    subprocess.run(command, check=True, capture_output=True)


def _time(action: Any) -> float:
    started = time.perf_counter()
    action()
    return time.perf_counter() - started


if __name__ == "__main__":
    main(measure, __doc__ or "")
