"""The linear model of RGB that the hybrid is compared with (section 5, last paragraph)."""

from collections.abc import Iterator
from functools import partial

import numpy as np
from jaxtyping import Bool, Float, Float32
from torch import Tensor

from skinnet.appearance._feature_blocks import FeatureBlocks
from skinnet.appearance._mixtures import Errors, errors
from skinnet.appearance._model import AppearanceModel
from skinnet.appearance.colour import SkinColour
from skinnet.appearance.skin_texture import SkinTexture
from skinnet.appearance.stack import SubjectStack


class _ColourBlocks:
    """The linear RGB [subjects, 3, columns] of a stack's features."""

    def __init__(self, features: FeatureBlocks, colour: SkinColour):
        self.features, self.colour = features, colour
        self.shape = (features.shape[0], 3, features.shape[2])

    def __iter__(self) -> Iterator[Float32[np.ndarray, "subjects 3 texels"]]:
        return map(self.colour.decode, self.features)


class LinearModel(AppearanceModel):
    """Principal components of linear RGB albedo, as in a classical morphable model.

    The albedo is that of equation 11, which holds exactly for an inverted texture with its offset.
    Channels are not scaled unless `scales` [3] are given. Where a subject lacks a texel, the colour
    of the mean features is taken.
    """

    @classmethod
    def read_blocks(cls, stack: SubjectStack, mask: Bool[np.ndarray, "size size"]) -> FeatureBlocks:
        return _ColourBlocks(stack.read_blocks(mask), stack.colour)

    @classmethod
    def default_scales(
        cls, grams: Float[np.ndarray, "channels subjects subjects"], texels: int
    ) -> Float[np.ndarray, "channels"]:
        return np.ones(len(grams))

    def row(self, texture: SkinTexture) -> Float32[np.ndarray, "channels texels"]:
        return self.colour.decode(texture.features())

    def colour_errors(
        self,
        stack: SubjectStack,
        grams: Float[np.ndarray, "channels subjects subjects"],
        texels: int | None,
    ) -> Errors:
        """RMS differences over the whole mask; inner products suffice, and no texel is decoded."""
        return partial(errors, grams.sum(0) / self.statistics.mean.size)

    def decode(
        self, features: Float[Tensor, "*batch channels texels"]
    ) -> Float[Tensor, "*batch 3 texels"]:
        return features
