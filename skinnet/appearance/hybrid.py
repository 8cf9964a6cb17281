"""The hybrid biophysical and statistical model (section 5 of Alotaibi & Smith 2017)."""

from functools import partial

import numpy as np
import torch
from jaxtyping import Bool, Float, Float32
from torch import Tensor

from skinnet.appearance._decoded_errors import compute_decoded_errors, subsample
from skinnet.appearance._feature_blocks import FeatureBlocks
from skinnet.appearance._mixtures import MixtureErrors
from skinnet.appearance._model import AppearanceModel
from skinnet.appearance._scales import compute_equal_effect, compute_equal_variance
from skinnet.appearance.colour import CHANNELS, SkinColour
from skinnet.appearance.skin_texture import SkinTexture
from skinnet.appearance.stack import SubjectStack


class HybridModel(AppearanceModel):
    """Principal components of pigments and offset, [f_blood, f_mel, dR, dG, dB].

    The features mix units, so each channel is divided by a scale before the analysis; the paper
    does not say how. By default hemoglobin, melanin and the offset have the same total variance.
    `fit(stack, scales=HybridModel.equal_effect_scales(stack))` scales them by their effect on RGB
    instead, and any five positive numbers are allowed.

    Fractions of a sample outside [0, 1] are clamped; `measure_clamping` gives their share.

    Args:
        statistics: Mean, basis and variances, as `fit` computes them.
        mask: Texels that are modelled, [size, size].
        colour: Light, camera and calibration of the textures.

    Source:
        Section 5 and Equations 9 to 11 of Alotaibi & Smith 2017.

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
        ...     model = HybridModel.fit(stack)
        >>> face = model.texture(model.sample(1, seed=0)[0])
        >>> len(model.statistics.variances), face.f_mel.shape
        (3, (4, 4))
    """

    @staticmethod
    def equal_effect_scales(
        stack: SubjectStack, mask: Bool[np.ndarray, "size size"] | None = None
    ) -> Float[np.ndarray, "5"]:
        """Compute scales by which a unit of each feature changes linear RGB by one.

        The change is that at the mean colour. Components are then ordered by their visible effect,
        to first order.

        Args:
            stack: The subjects.
            mask: Texels that count; None: those that all subjects have.

        Returns:
            One scale for each channel, for `fit`.
        """
        return compute_equal_effect(stack, mask)

    @classmethod
    def read_blocks(cls, stack: SubjectStack, mask: Bool[np.ndarray, "size size"]) -> FeatureBlocks:
        """Prepare to read pigments and offset, inside a mask.

        Args:
            stack: The subjects.
            mask: Texels that are read, [size, size].

        Returns:
            Blocks of the features of all subjects, read when they are iterated over.
        """
        return stack.read_blocks(mask)

    @classmethod
    def default_scales(
        cls, grams: Float[np.ndarray, "channels subjects subjects"], texels: int
    ) -> Float[np.ndarray, "channels"]:
        """Compute scales that give hemoglobin, melanin and the offset the same total variance.

        Args:
            grams: Gram matrices of the channels, [channels, subjects, subjects].
            texels: Number of texels.

        Returns:
            Scales [channels].
        """
        return compute_equal_variance(grams, texels)

    def extract_features(self, texture: SkinTexture) -> Float32[np.ndarray, "channels texels"]:
        """Stack the pigments and the offset of one subject (Equation 9).

        Args:
            texture: The subject.

        Returns:
            Features [channels, texels].
        """
        return texture.features()

    def decode(
        self, features: Float[Tensor, "*batch channels texels"]
    ) -> Float[Tensor, "*batch 3 texels"]:
        """Decode pigments and offset to linear RGB (Equation 11).

        Args:
            features: Features [..., channels, texels].

        Returns:
            Linear RGB [..., 3, texels].
        """
        rgb: Tensor = self.colour(features)
        return rgb

    def colour_errors(
        self,
        stack: SubjectStack,
        grams: Float[np.ndarray, "channels subjects subjects"],
        texels: int | None,
    ) -> MixtureErrors:
        """Prepare to compute RMS differences between decoded mixtures and subjects.

        Args:
            stack: The subjects.
            grams: Gram matrices of the channels, [channels, subjects, subjects].
            texels: Number of texels that are compared; None compares all.

        Returns:
            A function from weights of the subjects to errors.
        """
        blocks = self.read_blocks(stack, subsample(self.mask, texels))
        return partial(compute_decoded_errors, blocks, self.colour.decode)

    @torch.no_grad()
    def texture(self, beta: Float[np.ndarray, "components"], name: str = "face") -> SkinTexture:
        """Compute the maps of coefficients beta (Equation 10 of Alotaibi & Smith 2017).

        Args:
            beta: Coefficients.
            name: Name of the texture.

        Returns:
            Maps with fractions clamped to [0, 1], 0 outside the mask.
        """
        features = self.features(torch.from_numpy(beta).to(self.mean)).numpy(force=True)
        maps = np.zeros((len(CHANNELS), *self.mask.shape), np.float32)
        maps[:, self.mask] = features
        blood, mel = maps[:2].clip(0, 1)
        return SkinTexture(mel, blood, np.stack(list(maps[2:]), -1), self.mask, name)

    @torch.no_grad()
    def measure_clamping(self, betas: Float[np.ndarray, "samples components"]) -> float:
        """Compute the share of texels in these faces that have a fraction outside [0, 1].

        Args:
            betas: Coefficients, one row for each face.

        Returns:
            The share, from 0 to 1.
        """
        faces = (self.features(torch.from_numpy(beta).to(self.mean)) for beta in betas)
        return float(np.mean([SkinColour.share_outside(face.numpy(force=True)) for face in faces]))
