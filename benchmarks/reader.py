"""Reads photographs as for users: at the working size of a network, with maps resized to them."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
import torch
import torch.nn.functional as F
from numpy.typing import NDArray
from torch import Tensor

from benchmarks.pictures import Pictures, Pixels, select_skin
from skinnet.images import resize
from skinnet.network.autoencoder import SkinAutoencoder, SkinMaps
from skinnet.physics import Capture, SkinDecoder

LEAST_SIDE = 16

Reader = Callable[[NDArray[np.uint8]], tuple[SkinMaps, Capture]]
"""Reads uint8 sRGB [height, width, 3] as maps [1, (3,) height, width] and capture [1]."""


class NetworkReader:
    """Reads with a network, at its working size."""

    def __init__(self, model: SkinAutoencoder) -> None:
        self.model = model.eval()

    @torch.no_grad()
    def __call__(self, photograph: NDArray[np.uint8]) -> tuple[SkinMaps, Capture]:
        """Read a photograph."""
        height, width = photograph.shape[:2]
        scale = self.model.config.working_size / max(height, width)
        sides = (max(LEAST_SIDE, round(side * scale)) for side in (width, height))
        small = torch.from_numpy(resize(photograph, *sides)).movedim(-1, 0)[None]
        maps, capture = self.model.encode(small.float() / 255)
        return resize_maps(maps, height, width), capture


def resize_maps(maps: SkinMaps, height: int, width: int) -> SkinMaps:
    """Resize maps: bilinear, and averaged where they shrink."""
    channels = torch.cat([one if one.ndim == 4 else one[:, None] for one in maps], 1)
    if channels.shape[-2:] != (height, width):
        channels = F.interpolate(channels, (height, width), mode="bilinear", antialias=True)
    melanin, hemoglobin, shading, specular, *offset, mask = channels.unbind(1)
    return SkinMaps(melanin, hemoglobin, shading, specular, torch.stack(offset, 1), mask)


class Composition(NamedTuple):
    """A photograph made from a reading, in linear sRGB [1, 3, height, width].

    Attributes:
        albedo: The skin itself.
        explained: Skin with shading and specular reflection, clipped to [0, 1].
        image: The photograph, which has the offset too, clipped to [0, 1].
    """

    albedo: Tensor
    explained: Tensor
    image: Tensor


def compose(maps: SkinMaps, capture: Capture, decoder: SkinDecoder) -> Composition:
    """Make a photograph from a reading, step by step."""
    matrix = decoder.camera.matrix(capture)
    albedo = decoder.albedo(maps.melanin, maps.hemoglobin, matrix)
    white = matrix.sum(-2)[..., None, None]
    specular = maps.specular[:, None] * white
    explained = maps.shading[:, None] * albedo + specular
    return Composition(albedo, explained.clamp(0, 1), (explained + maps.offset).clamp(0, 1))


class Encoder:
    """A row of the table: synthetic faces, read one by one."""

    def __init__(self, reader: Reader, decoder: SkinDecoder) -> None:
        self.reader, self.decoder = reader, decoder

    def __call__(self, pictures: Pictures) -> Pixels:
        """Predict by reading every picture."""
        pairs = zip(pictures.photographs, pictures.skin, strict=True)
        parts = [self._read(photograph, skin[None]) for photograph, skin in pairs]
        return Pixels(*(torch.cat(values) for values in zip(*parts, strict=True)))

    @torch.no_grad()
    def _read(self, photograph: NDArray[np.uint8], skin: Tensor) -> Pixels:
        maps, capture = self.reader(photograph)
        composition = compose(maps, capture, self.decoder)
        values = [
            select_skin(one, skin) for one in (*maps[:4], composition.albedo, composition.image)
        ]
        return Pixels(*values, maps.mask > 0.5, select_skin(composition.explained, skin))
