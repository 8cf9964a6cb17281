"""An edit of the pigments of one subject, from what the encoder has read."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any, NamedTuple, Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from skinnet.errors import InputError
from skinnet.images._arguments import check_number
from skinnet.images.picture import Picture
from skinnet.images.resizing import resize
from skinnet.images.srgb import srgb_to_linear
from skinnet.inference._editing import ColourChange, ColourMeans, apply_change, compute_change
from skinnet.inference._head_crop import Arrays, HeadCrop
from skinnet.inference.onnx_model import CAPTURE_NAMES, MAP_NAMES, OnnxModel

MAX_FACTOR = 10.0
"""Largest factor of a pigment in an edit."""

EDITED_MAPS = ("melanin", "hemoglobin", "specular", "mask")
"""Maps of the encoder that an edit needs; shading and offset cancel in it."""


@runtime_checkable
class ModelPair(Protocol):
    """An encoder and its decoder, such as a `Decomposer` has."""

    @property
    def encoder(self) -> OnnxModel:
        """The network from photographs to maps."""

    @property
    def decoder(self) -> OnnxModel:
        """The skin model from maps to photographs."""


class EditSource(NamedTuple):
    """What is kept of a reading so that it can be edited.

    Attributes:
        picture: The photograph, as it was given.
        crop: The part of it that was read.
        outputs: The encoder's maps [1, h, w] that an edit needs, at the working size, and its
            capture [1, ...]; None if they are not those of the photograph as it was given, whose
            tone curve a profile has undone.
        models: What has read it; None for the shipped models.
        landmarks: Columns and rows of the face's landmarks in the photograph, [478, 2]; None if no
            face was looked for, or they are not kept.
    """

    picture: Picture
    crop: HeadCrop
    outputs: Arrays | None
    models: ModelPair | None = None
    landmarks: NDArray[np.float32] | None = None


def select_edited(encoder_outputs: Arrays) -> dict[str, NDArray[np.float32]]:
    """Select what an edit needs of the encoder's outputs."""
    return {name: encoder_outputs[name] for name in (*EDITED_MAPS, *CAPTURE_NAMES)}


def check_factors(**factors: Any) -> None:
    """Raise `InputError` for what is no factor of a pigment."""
    for pigment, factor in factors.items():
        number = check_number(f"The factor of {pigment}", factor)
        if not 0 <= number <= MAX_FACTOR:
            raise InputError(
                f"{pigment} is multiplied by a number in [0, {MAX_FACTOR:g}]; got {number:g}. "
                "1 leaves it as it is, 2 doubles it."
            )


def decode(decoder: OnnxModel, encoder_outputs: Arrays) -> NDArray[np.float32]:
    """Render maps [1, h, w] by the decoder: sRGB [h, w, 3] in [0, 1]."""
    inputs = {name: encoder_outputs[name] for name in (*MAP_NAMES, *CAPTURE_NAMES)}
    clipped: NDArray[np.float32] = np.clip(decoder.run(inputs)["image"][0], 0, 1)
    return clipped


def edit_in_place(
    colour: Picture,
    crop: HeadCrop,
    outputs: Arrays,
    skin: NDArray[np.float32],
    factors: Mapping[str, float],
    decoder: OnnxModel,
    share: NDArray[Any] | None = None,
    blood: NDArray[np.float32] | None = None,
) -> ColourMeans:
    """Multiply the pigments of one subject in the pixels of a picture.

    Args:
        colour: The picture, whose pixels are changed.
        crop: The part of it that was read.
        outputs: What `select_edited` selects.
        skin: Probability of skin in the box of the crop, [height, width].
        factors: Factors of melanin and hemoglobin.
        decoder: The skin model.
        share: How much of the edit each pixel of the picture gets, [H, W]; None for all.
        blood: Hemoglobin [1, h, w] in another state, which the factor multiplies; None for what
            was read.

    Returns:
        The mean colours before and after.
    """
    box, shape = crop.box, colour.pixels.shape
    change = _compute_change(decoder, outputs, factors, blood)
    fade = crop.fade(change.loss.shape[:2], shape)
    mask = skin if fade.min() == 1 else skin * resize(fade, box.width, box.height)
    alpha = None if colour.alpha is None else colour.alpha[box.slices]
    part = replace(colour, pixels=colour.pixels[box.slices], alpha=alpha)
    own_share = None if share is None else share[box.slices]
    return apply_change(part, change, outputs["specular"][0], mask, own_share)


def _compute_change(
    decoder: OnnxModel,
    outputs: Arrays,
    factors: Mapping[str, float],
    blood: NDArray[np.float32] | None = None,
) -> ColourChange:
    plain = np.ones_like(outputs["melanin"])
    bare = dict(outputs) | {
        "shading": plain,
        "specular": np.zeros_like(plain),
        "offset": np.zeros((*plain.shape, 3), np.float32),
    }
    levels = bare if blood is None else bare | {"hemoglobin": blood}
    scaled = {
        name: np.clip(levels[name] * np.float32(factor), 0, 1) for name, factor in factors.items()
    }
    before, after = (srgb_to_linear(decode(decoder, maps)) for maps in (bare, bare | scaled))
    return compute_change(before, after, outputs["mask"][0])
