"""The two graphs that are exported, with their named inputs and outputs."""

from typing import Any

import torch
from torch import Tensor, nn

from skinnet.network import (
    CAMERA_MAX,
    F_BLOOD_MAX,
    F_MEL_MAX,
    SHADING_MAX,
    WHITE_BALANCE_MAX,
    SkinAutoencoder,
)
from skinnet.physics import Capture, SkinDecoder, to_display

Output = dict[str, Any]


def _output(unit: str, low: float, high: float, description: str) -> Output:
    return {"unit": unit, "range": [low, high], "description": description}


OUTPUTS: dict[str, Output] = {
    "melanin": _output("volume fraction", 0, F_MEL_MAX, "melanosomes in the epidermis"),
    "hemoglobin": _output("volume fraction", 0, F_BLOOD_MAX, "blood in the papillary dermis"),
    "shading": _output("relative to the light", 0, SHADING_MAX, "diffuse shading of skin"),
    "specular": _output("relative to the light", 0, 1, "specular reflection of skin"),
    "offset": _output("linear sRGB", -1, 1, "what skin does not explain"),
    "mask": _output("probability", 0, 1, "that a pixel is skin"),
    "light": _output("weight", 0, 1, "convex mixture of the lights named in skinnet.lights"),
    "temperature": _output("K", 4000, 25000, "of the daylight among the lights"),
    "camera": _output("standard deviation", -CAMERA_MAX, CAMERA_MAX, "camera basis coefficients"),
    "white_balance": _output(
        "natural logarithm", -WHITE_BALANCE_MAX, WHITE_BALANCE_MAX, "error in R/G and in B/G"
    ),
}
DECODED: dict[str, Output] = {
    "image": _output("display sRGB", 0, 1, "the photograph that the maps make")
}


class EncoderGraph(nn.Module):
    """Computes the ten `OUTPUTS`, channels last, from uint8 sRGB [batch, height, width, 3]."""

    def __init__(self, model: SkinAutoencoder) -> None:
        super().__init__()
        self.model = model

    def forward(self, image: Tensor) -> tuple[Tensor, ...]:
        """Compute the outputs."""
        maps, capture = self.model.encode(image.movedim(-1, 1).float() / 255)
        named = {**maps._asdict(), **capture._asdict(), "offset": maps.offset.movedim(1, -1)}
        return tuple(named[name] for name in OUTPUTS)


class DecoderGraph(nn.Module):
    """Computes display sRGB, channels last, from the outputs of `EncoderGraph` but the mask."""

    def __init__(self, decoder: SkinDecoder) -> None:
        super().__init__()
        self.decoder = decoder

    def forward(
        self, melanin: Tensor, hemoglobin: Tensor, shading: Tensor, specular: Tensor,
        offset: Tensor, light: Tensor, temperature: Tensor, camera: Tensor, white_balance: Tensor,
    ) -> Tensor:  # fmt: skip
        """Render photographs from maps and captures."""
        capture = Capture(light, temperature, camera, white_balance)
        maps = (melanin, hemoglobin, shading, specular, offset.movedim(-1, 1))
        return to_display(self.decoder.compose(*maps, capture)).movedim(1, -1)


def make_example(batch: int, height: int, width: int) -> Tensor:
    """Generate random photographs of a size, the same on every run."""
    rng = torch.Generator().manual_seed(height * 10_000 + width)
    return torch.randint(0, 256, (batch, height, width, 3), generator=rng, dtype=torch.uint8)
