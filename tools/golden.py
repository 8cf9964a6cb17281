"""Golden outputs of the shipped model: `python -m tools.golden` after new weights are shipped.

Written by onnxruntime from `skin.onnx`; the tests hold torch and onnxruntime alike to them, and any
other client can.
"""

import json
from collections.abc import Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from skimage.data import astronaut

from skinnet.inference import CAPTURE_NAMES, MAP_NAMES, SHIPPED_ENCODER, open_model

GOLDEN = Path(__file__).parents[1] / "tests" / "golden.json"
PLACES = ((20, 30), (45, 38), (50, 52), (60, 45), (66, 50), (90, 20))
"""Row and column of the pixels that are written out: hair, cheeks, nose, lips, suit."""


def photograph() -> NDArray[np.uint8]:
    """uint8 sRGB [1, 100, 90, 3]: the astronaut's head, every other pixel."""
    return np.ascontiguousarray(astronaut()[None, :200:2, 120:300:2])


def numbers(outputs: Mapping[str, NDArray[np.float32]]) -> dict[str, list[float]]:
    """Mean, spread and some pixels of each map [1, height, width, ...], and every global."""
    found = {}
    for name in (*MAP_NAMES, "mask"):
        value = outputs[name][0].astype(np.float64)
        pixels = np.ravel([value[place] for place in PLACES])
        found[name] = [float(value.mean()), float(value.std()), *map(float, pixels)]
    return found | {name: np.ravel(outputs[name]).tolist() for name in CAPTURE_NAMES}


def main() -> None:
    """Write the golden file from the shipped ONNX."""
    outputs = open_model(SHIPPED_ENCODER, "encoder", 1).run({"image": photograph()})
    rounded = {
        name: [float(f"{value:.6g}") for value in values]
        for name, values in numbers(outputs).items()
    }
    GOLDEN.write_text(json.dumps(rounded, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
