"""Synthetic faces with the truth of their skin, pixel by pixel."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import torch
from kornia.color import rgb_to_linear_rgb
from numpy.typing import NDArray
from torch import Tensor

from benchmarks.typology import compute_typology_angle
from skinnet.physics import Capture, SkinDecoder
from train.batch import Batch


class Pixels(NamedTuple):
    """A prediction or the truth for each pixel of true skin; None for what is not predicted.

    Attributes:
        melanin: Volume fraction, [pixels].
        hemoglobin: Volume fraction, [pixels].
        shading: Diffuse shading, [pixels].
        specular: Specular reflection, [pixels].
        albedo: Linear sRGB of the skin itself, [pixels, 3].
        colour: Linear sRGB of the photograph, [pixels, 3].
        mask: Where the pictures show skin, [pictures, height, width].
        explained: Linear sRGB of the photograph without an offset, [pixels, 3].
        sd: Standard deviations of the logarithms of melanin and hemoglobin, [pixels, 2].
        face_sd: Those of their means over each picture, [pictures, 2].
    """

    melanin: Tensor
    hemoglobin: Tensor
    shading: Tensor | None
    specular: Tensor | None
    albedo: Tensor | None
    colour: Tensor | None
    mask: Tensor | None
    explained: Tensor | None = None
    sd: Tensor | None = None
    face_sd: Tensor | None = None


class Pictures(NamedTuple):
    """Synthetic faces and their truth.

    Attributes:
        photographs: uint8 sRGB, [pictures, height, width, 3].
        truth: True values of the pixels of skin.
        picture: Number of the picture of each pixel, [pixels].
        angle: Typology angle of the mean true skin under D65 and the mean camera, [pictures].
        known: White balance, light and camera of each picture; None where they are not kept.
    """

    photographs: NDArray[np.uint8]
    truth: Pixels
    picture: Tensor
    angle: Tensor
    known: Capture | None = None

    @property
    def skin(self) -> Tensor:
        """Return the true skin mask, [pictures, height, width]."""
        assert self.truth.mask is not None
        return self.truth.mask


def collect_pictures(batch: Batch, decoder: SkinDecoder) -> Pictures:
    """Collect the pixels whose true skin mask is above one half."""
    assert batch.truth is not None and batch.albedo is not None
    skin = batch.mask > 0.5
    maps = batch.truth
    truth = Pixels(
        *(select_skin(one, skin) for one in maps[:4]),
        select_skin(batch.albedo, skin),
        select_skin(rgb_to_linear_rgb(batch.photograph), skin),
        skin,
    )
    picture = skin.nonzero()[:, 0]
    eight_bits = (255 * batch.photograph).round().to(torch.uint8).movedim(1, -1).contiguous()
    colour = render_under_daylight(truth.melanin, truth.hemoglobin, decoder)
    angle = compute_typology_angle(average_by_picture(colour, picture, len(skin)))
    return Pictures(eight_bits.numpy(), truth, picture, angle, find_known(batch))


def find_known(batch: Batch) -> Capture:
    """Find what a careful user knows of each capture: balance, light, camera, linear or not."""
    assert batch.capture is not None
    return batch.capture._replace(exposure=None)


def choose_known(known: Capture, names: Sequence[str]) -> Capture:
    """Choose the parts of captures that are told; the others are None."""
    return Capture(**{name: getattr(known, name) for name in names})


def select_skin(values: Tensor, skin: Tensor) -> Tensor:
    """Select values [b, h, w] or [b, 3, h, w] of skin as [pixels] or [pixels, 3]."""
    return (values if values.ndim == 3 else values.movedim(1, -1))[skin]


def render_under_daylight(melanin: Tensor, hemoglobin: Tensor, decoder: SkinDecoder) -> Tensor:
    """Render skin under D65 and the mean camera as linear sRGB [pixels, 3]."""
    matrix = decoder.camera.matrix(decoder.camera.standard())
    image = decoder.albedo(melanin[None, None], hemoglobin[None, None], matrix[None])
    return image[0, :, 0].mT


def average_by_picture(values: Tensor, picture: Tensor, count: int) -> Tensor:
    """Average [pixels, ...] to [pictures, ...] in float64; NaN for a picture without skin."""
    sums = values.new_zeros(count, *values.shape[1:], dtype=torch.float64)
    sums.index_add_(0, picture, values.double())
    number = picture.bincount(minlength=count).to(sums)
    return sums / number.reshape(-1, *[1] * (values.ndim - 1))
