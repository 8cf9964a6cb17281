"""What the network is told of the capture of a rendered picture."""

import torch
from jaxtyping import Float
from torch import Tensor

from skinnet.network._known_capture import KnownCapture
from skinnet.physics import Capture, SpectralCamera
from train.synthetic.scene import CameraParameters


def tell_capture(camera: CameraParameters, capture: Capture) -> Capture:
    """Replace by NaN what the network is not told, and add the error of the white reference.

    Args:
        camera: What is known of each picture's camera and light.
        capture: The true captures.

    Returns:
        The captures as the network is told them.
    """
    known = camera.known
    assert capture.linear is not None and capture.exposure is not None
    parts = {
        "light": (known.light, capture.light),
        "temperature": (known.temperature, capture.temperature),
        "camera": (known.camera, capture.camera),
        "white_balance": (known.white, capture.white_balance + known.white_error),
        "linear": (known.linear, capture.linear),
        "exposure": (known.exposure, capture.exposure),
    }
    return Capture(**{name: _hide(flag, value) for name, (flag, value) in parts.items()})


def find_white_balance(
    white: Float[Tensor, "batch 3"], model: SpectralCamera
) -> Float[Tensor, "batch 2"]:
    """Find the white balance of photographs that show white in these linear sRGB colours."""
    return KnownCapture(model).find_white_balance(white)


def _hide(flag: Float[Tensor, "batch"], value: Tensor) -> Tensor:
    shown = flag.reshape(-1, *[1] * (value.ndim - 1)) > 0
    return torch.where(shown, value, torch.full_like(value, torch.nan))
