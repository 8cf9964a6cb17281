"""Golden outputs of the shipped model: `python -m tools.golden` after new weights are shipped.

onnxruntime computes them from `skin.onnx`. The tests compare torch and onnxruntime with them, and
any other program that runs the model can do the same.
"""

import json
from collections.abc import Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from skimage.data import astronaut

from skinnet.inference import CAPTURE_NAMES, MAP_NAMES, SHIPPED_ENCODER, open_model
from skinnet.inference.onnx_model import _SD_NAMES

GOLDEN_FILE = Path(__file__).parents[1] / "tests" / "golden.json"
PIXELS = ((20, 30), (45, 38), (50, 52), (60, 45), (66, 50), (90, 20))
"""Row and column of the pixels that are written: hair, cheeks, nose, lips, suit."""


def load_photograph() -> NDArray[np.uint8]:
    """Load every other pixel of the astronaut's head, uint8 sRGB [1, 100, 90, 3]."""
    photo: NDArray[np.uint8] = astronaut()  # type: ignore[no-untyped-call]
    return np.ascontiguousarray(photo[None, :200:2, 120:300:2])


def summarise_outputs(outputs: Mapping[str, NDArray[np.float32]]) -> dict[str, list[float]]:
    """Summarise maps by mean, deviation and some pixels; give light and camera in full."""
    summary = {}
    for name in (*MAP_NAMES, "mask", *_SD_NAMES):
        value = outputs[name][0].astype(np.float64)
        pixels = np.ravel([value[pixel] for pixel in PIXELS])
        summary[name] = [float(value.mean()), float(value.std()), *map(float, pixels)]
    whole = (*CAPTURE_NAMES, "face_sd")
    return summary | {name: np.ravel(outputs[name]).tolist() for name in whole}


def main() -> None:
    """Write the golden file from the shipped ONNX file."""
    outputs = open_model(SHIPPED_ENCODER, "encoder", 1).run({"image": load_photograph()})
    rounded = {
        name: [float(f"{value:.6g}") for value in values]
        for name, values in summarise_outputs(outputs).items()
    }
    GOLDEN_FILE.write_text(json.dumps(rounded, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
