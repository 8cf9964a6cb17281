"""The networks that find faces, opened once."""

from functools import cache
from importlib.resources import as_file, files
from threading import Lock, Thread

import numpy as np
import onnxruntime
from numpy.typing import NDArray

_OPENING = Lock()


def open_ahead() -> None:
    """Begin to open the networks, so that they open while a photograph is read."""
    # Not a daemon: a process that ends must not leave onnxruntime half-way through a file.
    Thread(
        target=lambda: [open_face_model(name) for name in ("face_detector", "face_mesh")]
    ).start()


def open_face_model(name: str) -> onnxruntime.InferenceSession:
    """Open `face_detector` or `face_mesh`, once."""
    with _OPENING:
        return _open(name)


@cache
def _open(name: str) -> onnxruntime.InferenceSession:
    options = onnxruntime.SessionOptions()
    options.log_severity_level = 4
    # The networks are small: more threads win nothing, and wait busily.
    options.intra_op_num_threads = 1
    # Optimising the mesh's graph takes 80 ms, and saves 4 ms a face.
    if name == "face_mesh":
        options.graph_optimization_level = onnxruntime.GraphOptimizationLevel.ORT_DISABLE_ALL
    with as_file(files(__package__) / "models" / f"{name}.onnx") as path:
        return onnxruntime.InferenceSession(path, options, providers=["CPUExecutionProvider"])


def run_face_model(name: str, image: NDArray[np.float32]) -> dict[str, NDArray[np.float32]]:
    """The outputs, by name, for an image [size, size, 3]."""
    session = open_face_model(name)
    names = [output.name for output in session.get_outputs()]
    values = session.run(names, {session.get_inputs()[0].name: image[None]})
    return dict(zip(names, values, strict=True))
