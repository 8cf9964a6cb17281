"""The mask of what is read, at full resolution, and the network's maps where the mask is larger."""

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from skinnet.images._face_skin import segment_face_skin
from skinnet.images.resizing import resize
from skinnet.images.srgb import srgb_to_linear
from skinnet.inference._head_crop import Arrays
from skinnet.inference._subject import Subject
from skinnet.inference.decomposition import SKIN_THRESHOLD

_NEARBY = 4.0
"""Standard deviation, in pixels of the network, of the Gaussian that averages skin nearby."""


def find_skin(
    photo: NDArray[np.uint8], subject: Subject, coarse: NDArray[np.float32]
) -> NDArray[np.float32]:
    """Find the skin of a subject at full resolution.

    Args:
        photo: uint8 sRGB [H, W, 3].
        subject: A face, or the whole photograph.
        coarse: The network's probability of skin in the subject's box, [h, w].

    Returns:
        Probability of skin in the subject's box, float32 [height, width].
    """
    box = subject.crop.box
    if subject.skin is not None:
        return subject.skin
    if subject.face is None or not (coarse > SKIN_THRESHOLD).any():
        return resize(coarse, box.width, box.height)
    landmarks = subject.face.landmarks - np.array([box.left, box.top], np.float32)
    return subject.keep_own_skin(segment_face_skin(photo[box.slices], landmarks, coarse))


def adopt_mask(
    outputs: Arrays, mask: NDArray[np.float32], crop: NDArray[np.uint8]
) -> dict[str, NDArray[np.float32]]:
    """Give the encoder's outputs [1, h, w] a mask [H, W] of a crop, uint8 sRGB [H, W, 3].

    Where the network saw no skin, it explains the photograph by its offset. Where the mask has skin
    nevertheless, the offset is that of the skin nearby, and what is brighter than the skin nearby
    in all channels is specular reflection.
    """
    coarse, offset, specular = (outputs[name][0] for name in ("mask", "offset", "specular"))
    height, width = coarse.shape
    small = resize(mask, width, height).clip(0, 1)
    added = (small - coarse).clip(0, 1)
    diffuse = srgb_to_linear(resize(crop, width, height)) - specular[..., None]
    excess = (diffuse - _average_nearby(diffuse, coarse)).min(-1).clip(0)
    nearby = _average_nearby(offset, coarse)
    mended = {
        "mask": small,
        "offset": offset + added[..., None] * (nearby - offset),
        "specular": specular + added * excess,
    }
    return dict(outputs) | {name: one[None].astype(np.float32) for name, one in mended.items()}


def _average_nearby(
    values: NDArray[np.float32], weight: NDArray[np.float32]
) -> NDArray[np.float32]:
    """Mean of values [h, w, 3] around each pixel, with weights [h, w]."""
    total = ndimage.gaussian_filter(weight, _NEARBY)[..., None] + np.float32(1e-3)
    sums = ndimage.gaussian_filter(weight[..., None] * values, (_NEARBY, _NEARBY, 0))
    return np.asarray(sums / total, np.float32)
