"""What the hybrid and the linear model share."""

from abc import ABC, abstractmethod
from pathlib import Path
from typing import TypeVar

import numpy as np
import torch
from jaxtyping import Bool, Float, Float32
from torch import Tensor, nn

from skinnet.appearance import _model_arrays
from skinnet.appearance._feature_blocks import FeatureBlocks
from skinnet.appearance._mixtures import Errors
from skinnet.appearance._principal import PrincipalComponents, compute_components, compute_grams
from skinnet.appearance.colour import SkinColour
from skinnet.appearance.skin_texture import SkinTexture
from skinnet.appearance.stack import SubjectStack
from skinnet.errors import InputError

Model = TypeVar("Model", bound="AppearanceModel")


class AppearanceModel(nn.Module, ABC):
    """Faces' albedo as coefficients beta: x(beta) = mean + scales * (beta P), decoded to RGB.

    Called with beta [..., K], as a tensor, it gives linear RGB [..., 3, n, n], 0 outside `mask`,
    and gradients; `statistics` holds the same numbers as arrays, which share their memory until the
    module is moved or converted. beta_k has mean 0 and variance `statistics.variances[k]` over
    people. `colour` is the light, camera and calibration under which the albedo was seen.
    """

    mean: Tensor
    basis: Tensor
    scales: Tensor
    texels: Tensor

    def __init__(
        self,
        statistics: PrincipalComponents,
        mask: Bool[np.ndarray, "size size"],
        colour: SkinColour,
    ):
        super().__init__()
        self.statistics, self.mask, self.colour = statistics, mask, colour
        buffers = {
            "mean": statistics.mean,
            "basis": statistics.basis,
            "scales": statistics.scales.astype(np.float32),
            "texels": np.flatnonzero(mask),
        }
        for name, value in buffers.items():
            self.register_buffer(name, torch.from_numpy(value), persistent=False)

    @classmethod
    def fit(
        cls: type[Model],
        stack: SubjectStack,
        components: int | None = None,
        mask: Bool[np.ndarray, "size size"] | None = None,
        scales: Float[np.ndarray, "channels"] | None = None,
    ) -> Model:
        """Principal components of a stack of subjects, in two passes over it.

        `components` is at most the number of subjects less one; None keeps all up to 100. `mask` is
        by default `stack.cover().mask`, the texels that all subjects have; where a texel of it is
        unknown in a subject, the mean of the others is taken. `scales` divide the channels before
        the analysis; the default is the class's own.

        Raises `InputError` for more components than the subjects span, subjects that are all the
        same, a mask of another size or with a texel that nobody has, and scales that are not
        positive.
        """
        mask = stack.cover().mask if mask is None else mask
        columns = cls.read_blocks(stack, mask)
        grams = compute_grams(columns)
        scales = cls.default_scales(grams, columns.shape[2]) if scales is None else scales
        if scales.shape != (columns.shape[1],) or not (np.isfinite(scales) & (scales > 0)).all():
            raise InputError(
                f"scales are {columns.shape[1]} positive numbers, one a channel; got {scales}."
            )
        statistics = compute_components(columns, grams, scales.astype(np.float64), components)
        return cls(statistics, mask, stack.colour)

    @classmethod
    @abstractmethod
    def read_blocks(cls, stack: SubjectStack, mask: Bool[np.ndarray, "size size"]) -> FeatureBlocks:
        """The features of a stack that the model is made of, inside a mask."""

    @classmethod
    @abstractmethod
    def default_scales(
        cls, grams: Float[np.ndarray, "channels subjects subjects"], texels: int
    ) -> Float[np.ndarray, "channels"]:
        """What each channel is divided by if nothing else is asked for."""

    @abstractmethod
    def row(self, texture: SkinTexture) -> Float32[np.ndarray, "channels texels"]:
        """The features of every texel of one subject."""

    @abstractmethod
    def decode(
        self, features: Float[Tensor, "*batch channels texels"]
    ) -> Float[Tensor, "*batch 3 texels"]:
        """Linear RGB of features."""

    @abstractmethod
    def colour_errors(
        self,
        stack: SubjectStack,
        grams: Float[np.ndarray, "channels subjects subjects"],
        texels: int | None,
    ) -> Errors:
        """RMS differences in linear RGB between mixtures of a stack's subjects and each of them.

        A mixture is made in the model's features, with weights of unit sum; `grams` are their
        `compute_grams`. None: over the whole mask; else `texels` of it stand for all.
        """

    @property
    def explained(self) -> Float[np.ndarray, "components"]:
        """Share of the variance of the scaled features that each component has."""
        return self.statistics.variances / self.statistics.total

    def forward(
        self, beta: Float[Tensor, "*batch components"]
    ) -> Float[Tensor, "*batch 3 size size"]:
        """Linear RGB of coefficients; 0 outside the mask."""
        rgb = self.decode(self.features(beta))
        blank = rgb.new_zeros(*rgb.shape[:-1], self.mask.size)
        pictures: Tensor = blank.index_copy(-1, self.texels, rgb).unflatten(-1, self.mask.shape)
        return pictures

    def features(
        self, beta: Float[Tensor, "*batch components"]
    ) -> Float[Tensor, "*batch channels texels"]:
        """The features of the texels in the mask (equation 10)."""
        varied = (beta @ self.basis.flatten(1)).unflatten(-1, self.mean.shape)
        features: Tensor = self.mean + self.scales[:, None] * varied
        return features

    def project(self, texture: SkinTexture) -> Float[np.ndarray, "components"]:
        """Beta of a face: least squares over the texels of the mask that are known in it.

        Raises `InputError` for a texture of another size, or one that knows too few texels.
        """
        if texture.mask.shape != self.mask.shape:
            raise InputError(
                f"{texture.name} has {len(texture.mask)} texels a side and the model "
                f"{len(self.mask)}; warp it to the model's resolution."
            )
        inside = self.row(texture)[:, self.mask.ravel()]
        return self.statistics.project(inside, texture.mask[self.mask])

    def coefficients(self, stack: SubjectStack) -> Float[np.ndarray, "subjects components"]:
        """Beta of a whole stack in one pass, its unknown texels filled as `fit` fills them."""
        return self.statistics.project_blocks(self.read_blocks(stack, self.mask))

    @torch.no_grad()
    def reconstruct(
        self, beta: Float[np.ndarray, "components"]
    ) -> Float32[np.ndarray, "size size 3"]:
        """Linear RGB albedo of coefficients, 0 outside the mask (equation 11)."""
        rgb = self(torch.from_numpy(beta).to(self.mean))
        return np.asarray(rgb.movedim(0, -1).contiguous().numpy(force=True))

    def sample(self, count: int, seed: int) -> Float[np.ndarray, "samples components"]:
        """Beta of random faces, drawn from N(0, variances)."""
        return self.statistics.sample(count, seed)

    def save(self, path: Path) -> None:
        """Write the model as .npz, whole or not at all. Raises `InputError` for another suffix."""
        _model_arrays.save_model(path, type(self).__name__, self.statistics, self.mask, self.colour)

    @classmethod
    def load(cls: type[Model], path: Path) -> Model:
        """Read a model. Raises `InputError` for a file that is missing, damaged or not of its kind.

        Nothing in it is unpickled.
        """
        return cls(*_model_arrays.load_model(path, cls.__name__))
