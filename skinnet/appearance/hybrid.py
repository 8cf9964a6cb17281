"""The hybrid of biophysical and statistical modelling (Alotaibi & Smith 2017, section 5)."""

from functools import partial

import numpy as np
import torch
from jaxtyping import Bool, Float, Float32
from torch import Tensor

from skinnet.appearance._decoded_errors import compute_decoded_errors, subsample
from skinnet.appearance._feature_blocks import FeatureBlocks
from skinnet.appearance._mixtures import Errors
from skinnet.appearance._model import AppearanceModel
from skinnet.appearance._scales import equal_variance
from skinnet.appearance.colour import CHANNELS, SkinColour
from skinnet.appearance.skin_texture import SkinTexture
from skinnet.appearance.stack import SubjectStack


class HybridModel(AppearanceModel):
    """Principal components of [f_blood, f_mel, dR, dG, dB] (equations 9 to 11).

    The features mix units, so blocks are divided by a scale before the analysis. The paper does not
    say how. By default hemoglobin, melanin and the offset have the same total variance
    (`equal_variance`); `fit(stack, scales=equal_effect(stack))` weighs them by what they change in
    RGB, and any five positive numbers will do.

    Fractions that a sample brings outside [0, 1] count as 0 or 1; `clamped` says how many do.
    """

    @classmethod
    def read_blocks(cls, stack: SubjectStack, mask: Bool[np.ndarray, "size size"]) -> FeatureBlocks:
        return stack.read_blocks(mask)

    @classmethod
    def default_scales(
        cls, grams: Float[np.ndarray, "channels subjects subjects"], texels: int
    ) -> Float[np.ndarray, "channels"]:
        return equal_variance(grams, texels)

    def row(self, texture: SkinTexture) -> Float32[np.ndarray, "channels texels"]:
        return texture.features()

    def decode(
        self, features: Float[Tensor, "*batch channels texels"]
    ) -> Float[Tensor, "*batch 3 texels"]:
        rgb: Tensor = self.colour(features)
        return rgb

    def colour_errors(
        self,
        stack: SubjectStack,
        grams: Float[np.ndarray, "channels subjects subjects"],
        texels: int | None,
    ) -> Errors:
        columns = self.read_blocks(stack, subsample(self.mask, texels))
        return partial(compute_decoded_errors, columns, self.colour.decode)

    @torch.no_grad()
    def texture(self, beta: Float[np.ndarray, "components"], name: str = "face") -> SkinTexture:
        """The maps of coefficients, fractions in [0, 1]; 0 outside the mask."""
        features = self.features(torch.from_numpy(beta).to(self.mean)).numpy(force=True)
        maps = np.zeros((len(CHANNELS), *self.mask.shape), np.float32)
        maps[:, self.mask] = features
        blood, mel = maps[:2].clip(0, 1)
        return SkinTexture(mel, blood, np.stack(list(maps[2:]), -1), self.mask, name)

    @torch.no_grad()
    def clamped(self, betas: Float[np.ndarray, "samples components"]) -> float:
        """Share of texels, over these faces, with a fraction outside [0, 1]."""
        faces = (self.features(torch.from_numpy(beta).to(self.mean)) for beta in betas)
        return float(np.mean([SkinColour.share_outside(face.numpy(force=True)) for face in faces]))
