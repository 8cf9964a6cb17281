"""Shape and appearance together, which the paper names as future work (section 7)."""

from pathlib import Path

import numpy as np
import torch
from jaxtyping import Float
from torch import Tensor, nn

from skinnet.appearance import _model_arrays
from skinnet.appearance._feature_blocks import ArrayBlocks
from skinnet.appearance._principal import (
    PrincipalComponents,
    compute_components,
    compute_grams,
)
from skinnet.errors import InputError


class JointModel(nn.Module):
    """Principal components of [w alpha / deviations, beta], as in an active appearance model.

    alpha [S] are coefficients of a `ShapeModel` and beta [K] those of an `AppearanceModel`, which
    stay what they are; gamma [J] are the joint ones. Called with gamma [..., J], as a tensor, it
    gives alpha [..., S] and beta [..., K], and gradients. `weight` is w, which trades shape for
    appearance; by default both have the same total variance (Cootes et al. 2001).
    """

    mean: Tensor
    basis: Tensor
    units: Tensor

    def __init__(
        self,
        statistics: PrincipalComponents,
        deviations: Float[np.ndarray, "modes"],
        weight: float,
    ):
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
        """Joint components of the same people's shapes and appearances, row by row.

        `deviations` are the standard deviations of alpha, sqrt(ShapeModel.variances), and `betas`
        for instance `appearance.coefficients(stack)`. Raises `InputError` where rows or deviations
        do not match, a deviation or the weight is not positive, shapes do not vary, or more
        components are asked for than the people span.
        """
        if len(alphas) != len(betas):
            raise InputError(f"There are {len(alphas)} shapes and {len(betas)} appearances.")
        if deviations.shape != alphas.shape[1:] or not (deviations > 0).all():
            raise InputError(
                f"alpha has {alphas.shape[1]} coefficients and needs as many positive deviations; "
                f"got {deviations.size}, the least {deviations.min(initial=np.inf):g}."
            )
        weight = equal_weight(alphas / deviations, betas) if weight is None else weight
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
        """Share of the joint variance that each component has."""
        return self.statistics.variances / self.statistics.total

    def forward(
        self, gamma: Float[Tensor, "*batch components"]
    ) -> tuple[Float[Tensor, "*batch modes"], Float[Tensor, "*batch appearance"]]:
        """Alpha and beta of joint coefficients."""
        both = (self.mean + gamma @ self.basis) * self.units
        return both[..., : len(self.deviations)], both[..., len(self.deviations) :]

    def project(
        self, alpha: Float[np.ndarray, "modes"], beta: Float[np.ndarray, "appearance"]
    ) -> Float[np.ndarray, "components"]:
        """Joint coefficients of one face, by least squares."""
        both = np.concatenate([self.weight * alpha / self.deviations, beta])
        return self.statistics.project(both[None], np.ones(both.size, bool))

    @torch.no_grad()
    def reconstruct(
        self, gamma: Float[np.ndarray, "components"]
    ) -> tuple[Float[np.ndarray, "modes"], Float[np.ndarray, "appearance"]]:
        """Alpha and beta of joint coefficients, for arrays."""
        alpha, beta = self(torch.from_numpy(gamma).to(self.mean))
        return alpha.numpy(force=True), beta.numpy(force=True)

    def sample(self, count: int, seed: int) -> Float[np.ndarray, "samples components"]:
        """Joint coefficients of random faces, drawn from N(0, variances)."""
        return self.statistics.sample(count, seed)

    def save(self, path: Path) -> None:
        """Write the model as .npz, whole or not at all. Raises `InputError` for another suffix."""
        found = self.statistics
        header = {"weight": self.weight, "total": found.total, "subjects": found.subjects}
        arrays = {name: getattr(found, name) for name in _model_arrays.STATISTICS}
        arrays["deviations"] = self.deviations
        _model_arrays.write_arrays(path, type(self).__name__, header, arrays)

    @classmethod
    def load(cls, path: Path) -> "JointModel":
        """Read a model. Raises `InputError` for a file that is missing, damaged or another's."""
        names = (*_model_arrays.STATISTICS, "deviations")
        header, arrays = _model_arrays.read_arrays(path, cls.__name__, names)
        statistics = _model_arrays.build_statistics(path, header, arrays)
        deviations = arrays["deviations"]
        if deviations.ndim != 1 or len(deviations) > len(statistics.mean.T):
            raise _model_arrays.make_damage_error(path)
        try:
            return cls(statistics, deviations, float(header["weight"]))
        except _model_arrays.READ_ERRORS as error:
            raise _model_arrays.make_damage_error(path) from error


def equal_weight(
    scaled: Float[np.ndarray, "subjects modes"], betas: Float[np.ndarray, "subjects components"]
) -> float:
    """The weight that gives shape the total variance of appearance; infinite if shape has none."""
    shape = float(scaled.var(0).sum())
    return float(np.sqrt(betas.var(0).sum() / shape)) if shape > 0 else np.inf
