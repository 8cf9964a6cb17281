"""The linear model of RGB that the hybrid is compared with (section 5, last paragraph)."""

from collections.abc import Iterator
from functools import partial

import numpy as np
from jaxtyping import Bool, Float, Float32
from torch import Tensor

from skinnet.appearance._feature_blocks import FeatureBlocks
from skinnet.appearance._mixtures import MixtureErrors, compute_errors
from skinnet.appearance._model import AppearanceModel
from skinnet.appearance.colour import SkinColour
from skinnet.appearance.skin_texture import SkinTexture
from skinnet.appearance.stack import SubjectStack


class _ColourBlocks:
    """`FeatureBlocks` of linear RGB, decoded from those of pigments and offset."""

    def __init__(self, features: FeatureBlocks, colour: SkinColour) -> None:
        self.features, self.colour = features, colour
        self.shape = (features.shape[0], 3, features.shape[2])

    def __iter__(self) -> Iterator[Float32[np.ndarray, "subjects 3 texels"]]:
        return map(self.colour.decode, self.features)


class LinearModel(AppearanceModel):
    """Principal components of linear RGB albedo, as in a classical morphable model.

    The albedo comes from Equation 11, which is exact for an inverted texture with its offset.
    Channels are not scaled unless `scales` [3] are given. Where a subject lacks a texel, the model
    takes the colour of the mean features.

    Args:
        statistics: Mean, basis and variances, as `fit` computes them.
        mask: Texels that are modelled, [size, size].
        colour: Light, camera and calibration of the textures.

    Source:
        Section 5, last paragraph, of Alotaibi & Smith 2017.

    Example:
        >>> import tempfile
        >>> from pathlib import Path
        >>> from skinnet.appearance.colour import SkinColour
        >>> from skinnet.appearance.stack_writer import write_stack
        >>> def make(seed: int) -> SkinTexture:
        ...     maps = np.random.default_rng(seed).uniform(0.02, 0.1, (5, 4, 4)).astype(np.float32)
        ...     return SkinTexture(maps[0], maps[1], 0.1 * maps[2:].T, np.ones((4, 4), bool))
        >>> subjects = {str(seed): partial(make, seed) for seed in range(4)}
        >>> with tempfile.TemporaryDirectory() as folder:
        ...     stack = write_stack(Path(folder), subjects, SkinColour(nodes=(16, 16)), "example")
        ...     model = LinearModel.fit(stack)
        >>> model.reconstruct(model.sample(1, seed=0)[0]).shape
        (4, 4, 3)
    """

    @classmethod
    def read_blocks(cls, stack: SubjectStack, mask: Bool[np.ndarray, "size size"]) -> FeatureBlocks:
        """Prepare to read linear RGB, inside a mask.

        Args:
            stack: The subjects.
            mask: Texels that are read, [size, size].

        Returns:
            Blocks of the features of all subjects, read when they are iterated over.
        """
        return _ColourBlocks(stack.read_blocks(mask), stack.colour)

    @classmethod
    def default_scales(
        cls, grams: Float[np.ndarray, "channels subjects subjects"], texels: int
    ) -> Float[np.ndarray, "channels"]:
        """Return ones: channels are not scaled.

        Args:
            grams: Gram matrices of the channels, [channels, subjects, subjects].
            texels: Number of texels.

        Returns:
            Scales [channels].
        """
        return np.ones(len(grams))

    def extract_features(self, texture: SkinTexture) -> Float32[np.ndarray, "channels texels"]:
        """Compute the linear RGB of one subject.

        Args:
            texture: The subject.

        Returns:
            Features [channels, texels].
        """
        return self.colour.decode(texture.features())

    def colour_errors(
        self,
        stack: SubjectStack,
        grams: Float[np.ndarray, "channels subjects subjects"],
        texels: int | None,
    ) -> MixtureErrors:
        """Prepare to compute RMS differences over the whole mask from inner products alone.

        Args:
            stack: The subjects.
            grams: Gram matrices of the channels, [channels, subjects, subjects].
            texels: Number of texels that are compared; None compares all.

        Returns:
            A function from weights of the subjects to errors.
        """
        return partial(compute_errors, grams.sum(0) / self.statistics.mean.size)

    def decode(
        self, features: Float[Tensor, "*batch channels texels"]
    ) -> Float[Tensor, "*batch 3 texels"]:
        """Return the features, which are linear RGB already.

        Args:
            features: Features [..., channels, texels].

        Returns:
            Linear RGB [..., 3, texels].
        """
        return features
