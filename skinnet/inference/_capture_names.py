"""Light and camera of a photograph, with names."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from skinnet.errors import InputError
from skinnet.inference.onnx_model import OnnxModel

Outputs = Mapping[str, NDArray[np.float32]]


def name_light(outputs: Outputs, encoder: OnnxModel) -> dict[str, float]:
    """Name the weights of lights, and add the temperature of the daylight.

    Raises:
        InputError: The file of the encoder names another number of lights.
    """
    weights = outputs["light"][0].tolist()
    if len(weights) != len(encoder.lights):
        raise InputError(
            f"{encoder.path} names {len(encoder.lights)} lights, but gives {len(weights)} "
            "weights; export it again."
        )
    named = dict(zip(encoder.lights, weights, strict=True))
    return named | {"temperature_k": float(outputs["temperature"][0])}


def name_camera(outputs: Outputs) -> dict[str, Any]:
    """Name the components of the camera and the errors of its white balance."""
    r_over_g, b_over_g = np.exp(outputs["white_balance"][0].astype(np.float64)).tolist()
    return {
        "components": outputs["camera"][0].tolist(),
        "white_balance": {"r_over_g": r_over_g, "b_over_g": b_over_g},
    }
