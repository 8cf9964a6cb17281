"""A joint model of shape and appearance, future work in section 7 of Alotaibi & Smith 2017."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import torch
from jaxtyping import Float
from torch import Tensor, nn

from skinnet.appearance import _array_file, _model_arrays
from skinnet.appearance._feature_blocks import ArrayBlocks
from skinnet.appearance._principal import (
    PrincipalComponents,
    compute_components,
    compute_grams,
)
from skinnet.errors import InputError


class JointModel(nn.Module):
    """Principal components of [w alpha / deviations, beta], as in an active appearance model.

    alpha [S] are coefficients of a `ShapeModel`, and beta [K] are those of a `HybridModel` or
    `LinearModel`; both models stay unchanged. A call with joint coefficients gamma [..., J] gives
    alpha [..., S] and beta [..., K], and is differentiable. The larger the weight w, the more the
    components describe shape instead of appearance.

    Args:
        statistics: Mean, basis and variances, as `fit` computes them.
        deviations: Standard deviations of the shape's coefficients, [S].
        weight: The weight w.

    Source:
        Cootes et al. 2001, Active Appearance Models; section 7 of Alotaibi & Smith 2017 names the
        joint model as future work.

    Example:
        >>> rng = np.random.default_rng(0)
        >>> alphas, betas = rng.standard_normal((5, 3)), rng.standard_normal((5, 2))
        >>> model = JointModel.fit(alphas, betas, deviations=np.ones(3))
        >>> alpha, beta = model.reconstruct(model.project(alphas[0], betas[0]))
        >>> bool(np.allclose(alpha, alphas[0], atol=1e-4))
        True
    """

    mean: Tensor
    basis: Tensor
    units: Tensor

    def __init__(
        self,
        statistics: PrincipalComponents,
        deviations: Float[np.ndarray, "modes"],
        weight: float,
    ) -> None:
        super().__init__()
        self.statistics, self.deviations, self.weight = statistics, deviations, weight
        units = np.ones(statistics.mean.shape[1])
        units[: len(deviations)] = deviations / weight
        buffers = {"mean": statistics.mean[0], "basis": statistics.basis[:, 0], "units": units}
        for name, value in buffers.items():
            tensor = torch.from_numpy(value.astype(np.float32))
            self.register_buffer(name, tensor, persistent=False)

    @classmethod
    def fit(
        cls,
        alphas: Float[np.ndarray, "shapes modes"],
        betas: Float[np.ndarray, "faces components"],
        deviations: Float[np.ndarray, "deviations"],
        weight: float | None = None,
        components: int | None = None,
    ) -> "JointModel":
        """Fit joint components to the shapes and appearances of the same people.

        Args:
            alphas: Shape coefficients, one row for each person.
            betas: Appearance coefficients, such as `appearance.coefficients(stack)`.
            deviations: Standard deviations of alpha, the root of `ShapeModel.variances`.
            weight: w; None: shape and appearance have the same total variance.
            components: Number of joint components, less than that of people; None: all, up to 100.

        Returns:
            The model.

        Raises:
            InputError: If rows or deviations do not match, a deviation or the weight is not
                positive, shapes do not differ, or the people span fewer components.
        """
        if len(alphas) != len(betas):
            raise InputError(f"There are {len(alphas)} shapes and {len(betas)} appearances.")
        if deviations.shape != alphas.shape[1:] or not (deviations > 0).all():
            raise InputError(
                f"alpha has {alphas.shape[1]} coefficients and needs as many positive deviations; "
                f"got {deviations.size}, the least {deviations.min(initial=np.inf):g}."
            )
        weight = _balance(alphas / deviations, betas) if weight is None else weight
        if not 0 < weight < np.inf:
            raise InputError(
                f"The weight of shape is {weight:g}; give one above 0, and shapes that differ."
            )
        rows = ArrayBlocks(np.concatenate([weight * alphas / deviations, betas], 1))
        one = np.ones(1)
        statistics = compute_components(rows, compute_grams(rows), one, components)
        return cls(statistics, deviations, weight)

    @property
    def explained(self) -> Float[np.ndarray, "components"]:
        """Share of the joint variance that each component explains."""
        return self.statistics.variances / self.statistics.total

    def forward(
        self, gamma: Float[Tensor, "*batch components"]
    ) -> tuple[Float[Tensor, "*batch modes"], Float[Tensor, "*batch appearance"]]:
        """Compute alpha and beta from joint coefficients gamma.

        Args:
            gamma: Joint coefficients.

        Returns:
            Shape coefficients alpha and appearance coefficients beta.
        """
        both = (self.mean + gamma @ self.basis) * self.units
        return both[..., : len(self.deviations)], both[..., len(self.deviations) :]

    def project(
        self, alpha: Float[np.ndarray, "modes"], beta: Float[np.ndarray, "appearance"]
    ) -> Float[np.ndarray, "components"]:
        """Compute the joint coefficients gamma of one face by least squares.

        Args:
            alpha: Shape coefficients.
            beta: Appearance coefficients.

        Returns:
            Joint coefficients.
        """
        both = np.concatenate([self.weight * alpha / self.deviations, beta])
        return self.statistics.project(both[None], np.ones(both.size, bool))

    @torch.no_grad()
    def reconstruct(
        self, gamma: Float[np.ndarray, "components"]
    ) -> tuple[Float[np.ndarray, "modes"], Float[np.ndarray, "appearance"]]:
        """Compute alpha and beta from joint coefficients that are arrays.

        Args:
            gamma: Joint coefficients.

        Returns:
            Shape coefficients alpha and appearance coefficients beta.
        """
        alpha, beta = self(torch.from_numpy(gamma).to(self.mean))
        return alpha.numpy(force=True), beta.numpy(force=True)

    def sample(self, count: int, seed: int) -> Float[np.ndarray, "samples components"]:
        """Sample the joint coefficients of random faces from N(0, variances).

        Args:
            count: Number of faces.
            seed: The same seed gives the same faces, whatever their number.

        Returns:
            Joint coefficients, one row for each face.
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
        statistics = self.statistics
        header = {
            "weight": self.weight,
            "total": statistics.total,
            "subjects": statistics.subjects,
            **(origin or {}),
        }
        arrays = {name: getattr(statistics, name) for name in _model_arrays.STATISTICS}
        arrays["deviations"] = self.deviations
        _array_file.write_arrays(path, type(self).__name__, header, arrays)

    @classmethod
    def load(cls, path: Path) -> "JointModel":
        """Read a model that `save` wrote; nothing is unpickled.

        Args:
            path: The file.

        Returns:
            The model.

        Raises:
            InputError: If the file is missing, damaged or of another kind.
        """
        names = (*_model_arrays.STATISTICS, "deviations")
        header, arrays = _array_file.read_arrays(path, cls.__name__, names)
        statistics = _model_arrays.build_statistics(path, header, arrays)
        deviations = arrays["deviations"]
        if deviations.ndim != 1 or deviations.dtype.kind != "f":
            raise _array_file.make_damage_error(path)
        if not np.isfinite(deviations).all() or len(deviations) > len(statistics.mean.T):
            raise _array_file.make_damage_error(path)
        try:
            weight = float(header["weight"])
            if not 0 < weight < np.inf:
                raise _array_file.make_damage_error(path)
            return cls(statistics, deviations, weight)
        except _array_file.ARCHIVE_ERRORS as error:
            raise _array_file.make_damage_error(path) from error


def _balance(
    scaled: Float[np.ndarray, "subjects modes"], betas: Float[np.ndarray, "subjects components"]
) -> float:
    """Compute the weight that gives shape the total variance of appearance."""
    shape = float(scaled.var(0).sum())
    return float(np.sqrt(betas.var(0).sum() / shape)) if shape > 0 else np.inf
