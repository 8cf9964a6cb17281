"""Photographs read by a network as users' are: at its working size, and brought back."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
import torch
import torch.nn.functional as F
from numpy.typing import NDArray
from torch import Tensor

from benchmarks.scene import Pixels, Scene, on
from skinnet.images import resize
from skinnet.network.autoencoder import SkinAutoencoder, SkinMaps
from skinnet.physics import Capture, SkinDecoder

LEAST_SIDE = 16

Reader = Callable[[NDArray[np.uint8]], tuple[SkinMaps, Capture]]
"""uint8 sRGB [height, width, 3] to maps [1, (3,) height, width] and the capture [1]."""


class NetworkReader:
    """A network with a photograph's longer side at its working size."""

    def __init__(self, model: SkinAutoencoder):
        self.model = model.eval()

    @torch.no_grad()
    def __call__(self, photograph: NDArray[np.uint8]) -> tuple[SkinMaps, Capture]:
        height, width = photograph.shape[:2]
        scale = self.model.config.working_size / max(height, width)
        sides = (max(LEAST_SIDE, round(side * scale)) for side in (width, height))
        small = torch.from_numpy(resize(photograph, *sides)).movedim(-1, 0)[None]
        maps, capture = self.model.encode(small.float() / 255)
        return resized(maps, height, width), capture


def resized(maps: SkinMaps, height: int, width: int) -> SkinMaps:
    """Maps of another size, bilinear, averaged where they shrink."""
    channels = torch.cat([one if one.ndim == 4 else one[:, None] for one in maps], 1)
    if channels.shape[-2:] != (height, width):
        channels = F.interpolate(channels, (height, width), mode="bilinear", antialias=True)
    melanin, hemoglobin, shading, specular, *offset, mask = channels.unbind(1)
    return SkinMaps(melanin, hemoglobin, shading, specular, torch.stack(offset, 1), mask)


class Composed(NamedTuple):
    """Linear sRGB [1, 3, height, width] of the skin itself, of what light and gloss make of it, and
    of the photograph, which has the offset too. The last two are cut off at 1, as a photograph is.
    """

    albedo: Tensor
    explained: Tensor
    image: Tensor


def composed(maps: SkinMaps, capture: Capture, decoder: SkinDecoder) -> Composed:
    """The photograph that a reading makes, step by step."""
    matrix = decoder.camera.matrix(capture)
    albedo = decoder.albedo(maps.melanin, maps.hemoglobin, matrix)
    white = matrix.sum(-2)[..., None, None]
    gloss = maps.specular[:, None] * white
    explained = maps.shading[:, None] * albedo + gloss
    return Composed(albedo, explained.clamp(0, 1), (explained + maps.offset).clamp(0, 1))


class Encoder:
    """A row of the table: pictures of the twin, one by one, by a reader."""

    def __init__(self, reader: Reader, decoder: SkinDecoder):
        self.reader, self.decoder = reader, decoder

    def __call__(self, scene: Scene) -> Pixels:
        pairs = zip(scene.photographs, scene.skin, strict=True)
        parts = [self._read(photograph, skin[None]) for photograph, skin in pairs]
        return Pixels(*(torch.cat(values) for values in zip(*parts, strict=True)))

    @torch.no_grad()
    def _read(self, photograph: NDArray[np.uint8], skin: Tensor) -> Pixels:
        maps, capture = self.reader(photograph)
        made = composed(maps, capture, self.decoder)
        values = [on(one, skin) for one in (*maps[:4], made.albedo, made.image)]
        return Pixels(*values, maps.mask > 0.5, on(made.explained, skin))
