"""Pictures of the twin with the truth of their skin's pixels, in one long row."""

from typing import NamedTuple

import numpy as np
import torch
from kornia.color import rgb_to_linear_rgb
from numpy.typing import NDArray
from torch import Tensor

from benchmarks.typology import typology_angle
from skinnet.physics import SkinDecoder
from train.batch import Batch


class Pixels(NamedTuple):
    """What is said of each pixel of true skin; None where nothing is.

    `melanin`, `hemoglobin`, `shading`, `specular` [pixels]; `albedo` and `colour` [pixels, 3],
    linear sRGB of the skin itself and of the photograph. `mask` [pictures, height, width] is of
    whole pictures: where skin is said to be. `explained` [pixels, 3] is what skin, shading and
    gloss make of the photograph without an offset.
    """

    melanin: Tensor
    hemoglobin: Tensor
    shading: Tensor | None
    specular: Tensor | None
    albedo: Tensor | None
    colour: Tensor | None
    mask: Tensor | None
    explained: Tensor | None = None


class Scene(NamedTuple):
    """Photographs, uint8 sRGB [pictures, height, width, 3], and the truth.

    `picture` [pixels] numbers the picture of each pixel; `angle` [pictures] is the typology angle
    of the mean true skin under D65 and the mean camera.
    """

    photographs: NDArray[np.uint8]
    truth: Pixels
    picture: Tensor
    angle: Tensor

    @property
    def skin(self) -> Tensor:
        """Where there is skin, [pictures, height, width]."""
        assert self.truth.mask is not None
        return self.truth.mask


def scene(batch: Batch, decoder: SkinDecoder) -> Scene:
    """Pixels with a true skin mask above one half."""
    assert batch.truth is not None and batch.albedo is not None
    skin = batch.mask > 0.5
    maps = batch.truth
    truth = Pixels(
        *(on(one, skin) for one in maps[:4]),
        on(batch.albedo, skin),
        on(rgb_to_linear_rgb(batch.photograph), skin),
        skin,
    )
    picture = skin.nonzero()[:, 0]
    bytes_ = (255 * batch.photograph).round().to(torch.uint8).movedim(1, -1).contiguous()
    colour = under_daylight(truth.melanin, truth.hemoglobin, decoder)
    angle = typology_angle(mean_by(colour, picture, len(skin)))
    return Scene(bytes_.numpy(), truth, picture, angle)


def on(values: Tensor, skin: Tensor) -> Tensor:
    """Values [b, h, w] or [b, 3, h, w] at the skin's pixels, [pixels] or [pixels, 3]."""
    return (values if values.ndim == 3 else values.movedim(1, -1))[skin]


def under_daylight(melanin: Tensor, hemoglobin: Tensor, decoder: SkinDecoder) -> Tensor:
    """Linear sRGB [pixels, 3] of skin under D65, seen by the mean camera."""
    matrix = decoder.camera.matrix(decoder.camera.standard())
    image = decoder.albedo(melanin[None, None], hemoglobin[None, None], matrix[None])
    return image[0, :, 0].mT


def mean_by(values: Tensor, picture: Tensor, count: int) -> Tensor:
    """Means [pictures, ...] of [pixels, ...] in float64; NaN for a picture without skin."""
    sums = values.new_zeros(count, *values.shape[1:], dtype=torch.float64)
    sums.index_add_(0, picture, values.double())
    number = picture.bincount(minlength=count).to(sums)
    return sums / number.reshape(-1, *[1] * (values.ndim - 1))
