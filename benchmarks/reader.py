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
from skinnet.network.autoencoder import SkinAutoencoder, SkinMaps, Uncertainty
from skinnet.physics import Capture, SkinDecoder

LEAST_SIDE = 16

Reader = Callable[[NDArray[np.uint8]], tuple[SkinMaps, Capture]]
"""Reads uint8 sRGB [height, width, 3] as maps [1, (3,) height, width] and capture [1]."""


class NetworkReader:
    """Reads with a network, at its working size."""

    def __init__(self, model: SkinAutoencoder) -> None:
        self.model = model.eval()

    def __call__(self, photograph: NDArray[np.uint8]) -> tuple[SkinMaps, Capture]:
        """Read a photograph."""
        return self.read(photograph)[:2]

    @torch.no_grad()
    def read(
        self, photograph: NDArray[np.uint8], known: Capture | None = None
    ) -> tuple[SkinMaps, Capture, Uncertainty]:
        """Read a photograph, given what is known of its capture [1]."""
        height, width = photograph.shape[:2]
        scale = self.model.config.working_size / max(height, width)
        sides = (max(LEAST_SIDE, round(side * scale)) for side in (width, height))
        small = torch.from_numpy(resize(photograph, *sides)).movedim(-1, 0)[None]
        maps, capture, sd = self.model.encode(small.float() / 255, known)
        pixel = resize_channels(torch.stack([sd.melanin, sd.hemoglobin], 1), height, width)
        return resize_maps(maps, height, width), capture, Uncertainty(*pixel.unbind(1), sd.face)


def resize_maps(maps: SkinMaps, height: int, width: int) -> SkinMaps:
    """Resize maps: bilinear, and averaged where they shrink."""
    channels = torch.cat([one if one.ndim == 4 else one[:, None] for one in maps], 1)
    channels = resize_channels(channels, height, width)
    melanin, hemoglobin, shading, specular, *offset, mask = channels.unbind(1)
    return SkinMaps(melanin, hemoglobin, shading, specular, torch.stack(offset, 1), mask)


def resize_channels(channels: Tensor, height: int, width: int) -> Tensor:
    """Resize channels [1, channels, h, w] as maps are."""
    if channels.shape[-2:] == (height, width):
        return channels
    return F.interpolate(channels, (height, width), mode="bilinear", antialias=True)


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
    """A row of the table: synthetic faces, read one by one.

    Args:
        reader: Reads each photograph.
        told: Whether it is given the white balance, the light and the camera.
    """

    def __init__(self, reader: NetworkReader, told: bool = False) -> None:
        self.reader, self.told = reader, told

    def __call__(self, pictures: Pictures) -> Pixels:
        """Predict by reading every picture."""
        parts = [self._read(pictures, number) for number in range(len(pictures.photographs))]
        return Pixels(*(torch.cat(values) for values in zip(*parts, strict=True)))

    @torch.no_grad()
    def _read(self, pictures: Pictures, number: int) -> Pixels:
        row = slice(number, number + 1)
        skin = pictures.skin[row]
        known = pictures.known.map(lambda value: value[row]) if self.told else None
        maps, capture, sd = self.reader.read(pictures.photographs[number], known)
        composition = compose(maps, capture, self.reader.model.decoder)
        values = [
            select_skin(one, skin) for one in (*maps[:4], composition.albedo, composition.image)
        ]
        return Pixels(
            *values,
            maps.mask > 0.5,
            select_skin(composition.explained, skin),
            torch.stack([select_skin(one, skin) for one in sd[:2]], 1),
            sd.face,
        )
