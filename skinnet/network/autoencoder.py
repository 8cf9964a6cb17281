"""Encoder, controls and decoder: a photograph to skin and back."""

from dataclasses import dataclass
from typing import NamedTuple

import torch
from jaxtyping import Float
from kornia.color import rgb_to_linear_rgb
from torch import Tensor, nn

from skinnet.network.encoder import WIDTHS, SkinEncoder
from skinnet.physics.camera import CAMERA_COMPONENTS, LIGHTS
from skinnet.physics.capture import Capture
from skinnet.physics.decoder import SkinDecoder

FORMAT = 3
"""Version of weights and checkpoints: raise it with every change to what a weight means."""

F_MEL_MAX = 0.43
"""Largest melanosome volume fraction of the paper's Table 1."""

F_BLOOD_MAX = 0.15
"""Twice the paper's 7 %: lips and flushed cheeks hold more blood than other skin."""

SHADING_MAX = 4.0
CAMERA_MAX = 3.0
WHITE_BALANCE_MAX = 0.4
MIRED = (40.0, 250.0)
"""Daylight in units in which its change is even to the eye, 25,000 K to 4,000 K."""

MAPS = 5
GLOBALS = len(LIGHTS) + 1 + CAMERA_COMPONENTS + 2


class SkinMaps(NamedTuple):
    """What each pixel of a photograph shows.

    `melanin`, `hemoglobin`: melanosome and blood volume fractions, in [0, 0.43] and [0, 0.15].
    `shading`: diffuse shading relative to the light, in [0, 4]. `specular`: in [0, 1] of the
    light. `offset`: linear sRGB of what is not skin, in [-1, 1] (delta of the paper's equation
    11); what the encoder reads is in [0, 1]. `mask`: probability that the pixel is skin.
    """

    melanin: Float[Tensor, "*batch height width"]
    hemoglobin: Float[Tensor, "*batch height width"]
    shading: Float[Tensor, "*batch height width"]
    specular: Float[Tensor, "*batch height width"]
    offset: Float[Tensor, "*batch 3 height width"]
    mask: Float[Tensor, "*batch height width"]


def controls(
    maps: Float[Tensor, "batch 5 height width"],
    globals: Float[Tensor, "batch globals"],
    linear: Float[Tensor, "batch 3 height width"],
) -> tuple[SkinMaps, Capture]:
    """Raw outputs of the encoder mapped smoothly to physical ranges, in float32 at least.

    Pigments are cubes of a sigmoid: even steps of the cube root of a fraction are about even steps
    of colour, and both ends of the range can be reached. The offset is the photograph, `linear` in
    linear sRGB, by the share that the mask leaves: skin is explained by skin, the rest by itself.
    """
    maps, globals = _at_least_float32(maps), _at_least_float32(globals)
    melanin, hemoglobin, shading, specular, mask = maps.unbind(1)
    light, temperature, camera, balance = globals.split([len(LIGHTS), 1, CAMERA_COMPONENTS, 2], -1)
    mired = MIRED[0] + (MIRED[1] - MIRED[0]) * temperature.squeeze(-1).sigmoid()
    capture = Capture(
        light.softmax(-1),
        1e6 / mired,
        CAMERA_MAX * camera.tanh(),
        WHITE_BALANCE_MAX * balance.tanh(),
    )
    skin = mask.sigmoid()
    # Detached, or a photograph would be explained best by finding no skin in it.
    rest = (1 - skin.detach())[:, None] * linear
    found = SkinMaps(
        F_MEL_MAX * melanin.sigmoid() ** 3,
        F_BLOOD_MAX * hemoglobin.sigmoid() ** 3,
        SHADING_MAX * (shading - 1.1).sigmoid(),
        (specular - 4).sigmoid(),
        rest,
        skin,
    )
    return found, capture


def _at_least_float32(value: Tensor) -> Tensor:
    return value if value.dtype == torch.float64 else value.float()


class Reading(NamedTuple):
    """A photograph read as skin: its maps, its capture, and the photograph made from them."""

    maps: SkinMaps
    capture: Capture
    reconstruction: Float[Tensor, "batch 3 height width"]


@dataclass(frozen=True)
class AutoencoderConfig:
    """What a `SkinAutoencoder` is built from.

    `optics` names a preset, `widths` are the encoder's channels at each level, and `working_size`
    is the longer side, in pixels, of the crops that the weights are trained on.
    """

    optics: str = "calibrated"
    widths: tuple[int, ...] = WIDTHS
    working_size: int = 128


class SkinAutoencoder(nn.Module):
    """Photograph -> `SkinEncoder` -> `controls` -> `SkinDecoder` -> photograph.

    One forward pass serves training, inference and export. `skinnet.network._weights` saves and
    loads it.
    """

    def __init__(self, config: AutoencoderConfig | None = None):
        super().__init__()
        self.config = config or AutoencoderConfig()
        self.encoder = SkinEncoder(MAPS, GLOBALS, self.config.widths)
        self.decoder = SkinDecoder(self.config.optics)

    def forward(self, photograph: Float[Tensor, "batch 3 height width"]) -> Reading:
        """Read photographs in display sRGB, in [0, 1]; the reconstruction is linear sRGB."""
        maps, capture = self.encode(photograph)
        return Reading(maps, capture, self.decode(maps, capture))

    def encode(self, photograph: Float[Tensor, "batch 3 height width"]) -> tuple[SkinMaps, Capture]:
        """The maps and the capture alone; this half may run in lower precision."""
        linear = rgb_to_linear_rgb(photograph)
        maps, globals = self.encoder(photograph, linear)
        return controls(maps, globals, linear)

    def decode(self, maps: SkinMaps, capture: Capture) -> Float[Tensor, "batch 3 height width"]:
        """Linear sRGB of maps and capture; this half needs float32."""
        pixels = (maps.melanin, maps.hemoglobin, maps.shading, maps.specular, maps.offset)
        return self.decoder.compose(*pixels, capture)
