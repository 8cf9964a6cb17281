"""The two graphs that are exported, with their named inputs and outputs."""

from typing import Any

import torch
from torch import Tensor, nn

from skinnet.inference import CAPTURE_NAMES, MAP_NAMES
from skinnet.network import (
    CAMERA_MAX,
    F_BLOOD_MAX,
    F_MEL_MAX,
    SHADING_MAX,
    WHITE_BALANCE_MAX,
    SkinAutoencoder,
)
from skinnet.network._tone_factors import find_range
from skinnet.network.autoencoder import LOG_SD_RANGE
from skinnet.physics import CAMERA_COMPONENTS, LIGHTS, Capture, SkinDecoder, to_display

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
    "melanin_sd": _output("natural logarithm", *LOG_SD_RANGE, "standard deviation of a pixel"),
    "hemoglobin_sd": _output("natural logarithm", *LOG_SD_RANGE, "standard deviation of a pixel"),
    "face_sd": _output(
        *("natural logarithm", *LOG_SD_RANGE),
        "standard deviations of the means of melanin and hemoglobin over the skin",
    ),
}
DECODED: dict[str, Output] = {
    "image": _output("display sRGB", 0, 1, "the photograph that the maps make")
}
KNOWN: dict[str, tuple[int, ...]] = {
    "known_light": (len(LIGHTS),),
    "known_temperature": (),
    "known_camera": (CAMERA_COMPONENTS,),
    "known_white_balance": (2,),
    "known_linear": (),
    "known_exposure": (),
}
"""Optional inputs of the encoder in the order of `Capture`, and their shapes after the batch."""


class EncoderGraph(nn.Module):
    """Computes the `OUTPUTS`, channels last, from uint8 sRGB [batch, height, width, 3].

    What is `KNOWN` of each capture is NaN where it is not known.
    """

    def __init__(self, model: SkinAutoencoder) -> None:
        super().__init__()
        self.model = model

    def forward(
        self, image: Tensor, known_light: Tensor, known_temperature: Tensor,
        known_camera: Tensor, known_white_balance: Tensor, known_linear: Tensor,
        known_exposure: Tensor,
    ) -> tuple[Tensor, ...]:  # fmt: skip
        """Compute the outputs."""
        known = Capture(
            *(known_light, known_temperature, known_camera, known_white_balance),
            *(known_linear, known_exposure),
        )
        maps, capture, uncertainty = self.model.encode(image.movedim(-1, 1).float() / 255, known)
        named = {
            **{**maps._asdict(), "offset": maps.offset.movedim(1, -1)},
            **capture._asdict(),
            **{f"{name}_sd": value for name, value in uncertainty._asdict().items()},
        }
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


def describe_outputs(model: SkinAutoencoder) -> dict[str, Output]:
    """Describe the encoder's outputs, with the ranges of this model's standard deviations."""
    least, most = find_range(model.sd_scale, model.sd_by_tone)
    low, high = LOG_SD_RANGE
    ranges = {
        "melanin_sd": [low * float(least[0, 0]), high * float(most[0, 0])],
        "hemoglobin_sd": [low * float(least[0, 1]), high * float(most[0, 1])],
        "face_sd": [low * float(least[1].min()), high * float(most[1].max())],
    }
    return OUTPUTS | {name: OUTPUTS[name] | {"range": ends} for name, ends in ranges.items()}


def select_decoder_inputs(outputs: dict[str, Tensor]) -> dict[str, Tensor]:
    """Select the encoder's outputs that are inputs of the decoder."""
    return {name: outputs[name] for name in (*MAP_NAMES, *CAPTURE_NAMES)}


def make_example(batch: int, height: int, width: int) -> Tensor:
    """Generate random photographs of a size, the same on every run."""
    rng = torch.Generator().manual_seed(height * 10_000 + width)
    return torch.randint(0, 256, (batch, height, width, 3), generator=rng, dtype=torch.uint8)


def make_known(batch: int, is_known: bool = True) -> dict[str, Tensor]:
    """Generate what is known of captures: random values, the same on every run, or nothing."""
    shapes = {name: (batch, *shape) for name, shape in KNOWN.items()}
    if not is_known:
        return {name: torch.full(shape, torch.nan) for name, shape in shapes.items()}
    rng = torch.Generator().manual_seed(batch)
    values = {name: torch.rand(shape, generator=rng) for name, shape in shapes.items()}
    light = values["known_light"]
    return values | {
        "known_light": light / light.sum(-1, keepdim=True),
        "known_temperature": 4000 + 21000 * values["known_temperature"],
        "known_white_balance": values["known_white_balance"] - 0.5,
        "known_linear": values["known_linear"].round(),
    }
