"""The base class of the hybrid and the linear model."""

from abc import ABC, abstractmethod
from collections.abc import Mapping
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
import torch
from jaxtyping import Bool, Float, Float32
from torch import Tensor, nn

from skinnet.appearance import _model_arrays
from skinnet.appearance._feature_blocks import FeatureBlocks
from skinnet.appearance._mixtures import MixtureErrors
from skinnet.appearance._principal import PrincipalComponents, compute_components, compute_grams
from skinnet.appearance.colour import SkinColour
from skinnet.appearance.skin_texture import SkinTexture
from skinnet.appearance.stack import SubjectStack
from skinnet.errors import InputError

_Model = TypeVar("_Model", bound="AppearanceModel")


class AppearanceModel(nn.Module, ABC):
    """A linear model of features, x(beta) = mean + scales * (beta P), that are decoded to RGB.

    A call with coefficients beta [..., K] gives linear RGB [..., 3, n, n], 0 outside `mask`, and is
    differentiable. Over people, beta_k has mean 0 and variance `statistics.variances[k]`.
    `statistics` holds the numbers as arrays, which share memory with the buffers until the module
    is moved or converted. `colour` is the light, camera and calibration of the albedo.

    Source:
        Equation 10 of Alotaibi & Smith 2017.
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
    ) -> None:
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
        cls: type[_Model],
        stack: SubjectStack,
        components: int | None = None,
        mask: Bool[np.ndarray, "size size"] | None = None,
        scales: Float[np.ndarray, "channels"] | None = None,
    ) -> _Model:
        """Fit principal components to a stack of subjects, in two passes over it.

        Args:
            stack: The subjects.
            components: Number of components, less than that of subjects; None: all, up to 100.
            mask: Texels to model; None: those that all subjects have. A value that a subject lacks
                is the mean of the others.
            scales: What each channel of features is divided by before the analysis; None: the
                default of the class.

        Returns:
            The model.

        Raises:
            InputError: If the subjects do not differ or span fewer components, the mask has another
                size or a texel that no subject has, or a scale is not positive.

        Source:
            Section 5 of Alotaibi & Smith 2017.
        """
        mask = stack.cover().mask if mask is None else mask
        blocks = cls.read_blocks(stack, mask)
        grams = compute_grams(blocks)
        scales = cls.default_scales(grams, blocks.shape[2]) if scales is None else scales
        if scales.shape != (blocks.shape[1],) or not (np.isfinite(scales) & (scales > 0)).all():
            raise InputError(
                f"scales are {blocks.shape[1]} positive numbers, one a channel; got {scales}."
            )
        statistics = compute_components(blocks, grams, scales.astype(np.float64), components)
        return cls(statistics, mask, stack.colour)

    @classmethod
    @abstractmethod
    def read_blocks(cls, stack: SubjectStack, mask: Bool[np.ndarray, "size size"]) -> FeatureBlocks:
        """Prepare to read the features that the model is made of, inside a mask.

        Args:
            stack: The subjects.
            mask: Texels that are read, [size, size].

        Returns:
            Blocks of the features of all subjects, read when they are iterated over.
        """

    @classmethod
    @abstractmethod
    def default_scales(
        cls, grams: Float[np.ndarray, "channels subjects subjects"], texels: int
    ) -> Float[np.ndarray, "channels"]:
        """Compute what each channel is divided by, unless `fit` is given scales.

        Args:
            grams: Gram matrices of the channels, [channels, subjects, subjects].
            texels: Number of texels.

        Returns:
            Scales [channels].
        """

    @abstractmethod
    def extract_features(self, texture: SkinTexture) -> Float32[np.ndarray, "channels texels"]:
        """Compute the features of every texel of one subject.

        Args:
            texture: The subject.

        Returns:
            Features [channels, texels].
        """

    @abstractmethod
    def decode(
        self, features: Float[Tensor, "*batch channels texels"]
    ) -> Float[Tensor, "*batch 3 texels"]:
        """Decode features to linear RGB.

        Args:
            features: Features [..., channels, texels].

        Returns:
            Linear RGB [..., 3, texels].
        """

    @abstractmethod
    def colour_errors(
        self,
        stack: SubjectStack,
        grams: Float[np.ndarray, "channels subjects subjects"],
        texels: int | None,
    ) -> MixtureErrors:
        """Prepare to compute RMS differences in linear RGB between mixtures and subjects.

        A mixture of subjects is made in the model's features, with weights of unit sum.

        Args:
            stack: The subjects.
            grams: Inner products between their features, from `compute_grams`.
            texels: Number of texels of the mask to compare at; None: all.

        Returns:
            The differences, for any weights.
        """

    @property
    def explained(self) -> Float[np.ndarray, "components"]:
        """Share of the variance of the scaled features that each component explains."""
        return self.statistics.variances / self.statistics.total

    def forward(
        self, beta: Float[Tensor, "*batch components"]
    ) -> Float[Tensor, "*batch 3 size size"]:
        """Compute linear RGB from coefficients beta (Equations 10 and 11 of Alotaibi & Smith 2017).

        Args:
            beta: Coefficients.

        Returns:
            Linear RGB, 0 outside the mask.
        """
        rgb = self.decode(self.features(beta))
        blank = rgb.new_zeros(*rgb.shape[:-1], self.mask.size)
        pictures: Tensor = blank.index_copy(-1, self.texels, rgb).unflatten(-1, self.mask.shape)
        return pictures

    def features(
        self, beta: Float[Tensor, "*batch components"]
    ) -> Float[Tensor, "*batch channels texels"]:
        """Compute the features of the texels in the mask (Equation 10 of Alotaibi & Smith 2017).

        Args:
            beta: Coefficients.

        Returns:
            Features in the unit of each channel.
        """
        varied = (beta @ self.basis.flatten(1)).unflatten(-1, self.mean.shape)
        features: Tensor = self.mean + self.scales[:, None] * varied
        return features

    def project(self, texture: SkinTexture) -> Float[np.ndarray, "components"]:
        """Compute the coefficients beta of a face by least squares over its known texels.

        Args:
            texture: The face, at the model's resolution.

        Returns:
            Coefficients beta.

        Raises:
            InputError: If the texture has another size, or too few known texels.
        """
        if texture.mask.shape != self.mask.shape:
            raise InputError(
                f"{texture.name} has {len(texture.mask)} texels a side and the model "
                f"{len(self.mask)}; warp it to the model's resolution."
            )
        inside = self.extract_features(texture)[:, self.mask.ravel()]
        return self.statistics.project(inside, texture.mask[self.mask])

    def coefficients(self, stack: SubjectStack) -> Float[np.ndarray, "subjects components"]:
        """Compute the coefficients beta of every subject of a stack, in one pass over it.

        A value that a subject lacks is the mean of the others, as in `fit`.

        Args:
            stack: The subjects.

        Returns:
            Coefficients, one row for each subject.
        """
        return self.statistics.project_blocks(self.read_blocks(stack, self.mask))

    @torch.no_grad()
    def reconstruct(
        self, beta: Float[np.ndarray, "components"]
    ) -> Float32[np.ndarray, "size size 3"]:
        """Compute the linear RGB albedo of coefficients (Equation 11 of Alotaibi & Smith 2017).

        Args:
            beta: Coefficients.

        Returns:
            Linear RGB, 0 outside the mask.
        """
        rgb = self(torch.from_numpy(beta).to(self.mean))
        return np.asarray(rgb.movedim(0, -1).contiguous().numpy(force=True))

    def sample(self, count: int, seed: int) -> Float[np.ndarray, "samples components"]:
        """Sample the coefficients beta of random faces from N(0, variances).

        Args:
            count: Number of faces.
            seed: The same seed gives the same faces, whatever their number.

        Returns:
            Coefficients, one row for each face.
        """
        return self.statistics.sample(count, seed)

    def save(self, path: Path, origin: Mapping[str, Any] | None = None) -> None:
        """Write the model to a .npz file, all of it or nothing.

        Args:
            path: The file, with the suffix .npz.
            origin: What the file states of its origin, as of `save_maps`.

        Raises:
            InputError: If the path does not end in .npz or cannot be written.
        """
        _model_arrays.save_model(
            path, type(self).__name__, self.statistics, self.mask, self.colour, origin or {}
        )

    @classmethod
    def load(cls: type[_Model], path: Path) -> _Model:
        """Read a model that `save` wrote; nothing is unpickled.

        Args:
            path: The file.

        Returns:
            The model.

        Raises:
            InputError: If the file is missing, damaged or of another kind.
        """
        return cls(*_model_arrays.load_model(path, cls.__name__))
