"""The distribution of skins over people: melanin, blood, and what varies besides."""

import json
from collections.abc import Mapping
from functools import cache
from importlib.resources import files
from typing import Any

import torch
from jaxtyping import Float
from torch import Tensor
from torch.distributions import Categorical, MixtureSameFamily, MultivariateNormal

from skinnet.errors import InputError
from skinnet.physics.nuisance import Nuisance

TYPICAL_F_MEL, TYPICAL_F_BLOOD = 0.12, 0.045
"""Fractions at which the regression of the nuisance has its origin."""

_REFERENCE_F_BLOOD, _DEPTH_EXPONENT = 0.03, 1.5
"""Blood at which the typical thickness is the preset's, and the exponent of their relation."""


class SkinPrior:
    """Joint distribution of melanin, blood and nuisance over people, for the preset `measured`.

    ln f_mel and ln f_blood follow a mixture of normal distributions. Given both, the nuisance is
    normal about a mean that is linear in ln f_mel and ln f_blood. What the model leaves over at
    each band is normal about a mean that depends on ln f_mel and is linear in ln f_blood and
    nuisance. Both covariances depend on ln f_mel.

    A skin's fractions and nuisance are those that fit its spectrum best: the distribution is that
    of such fits, and what is left over is what they leave.

    Args:
        record: The content of `tables/prior.json`, which `python -m tools.fit_skin --write`
            writes; None: the distribution that was fitted to 100
            forearms (NIST) and 348 skins of many peoples (ISSA).

    Source:
        Fitted to NIST, doi 10.18434/M38597, and to Lu et al. 2025, doi
        10.6084/m9.figshare.28228571.v4.

    Example:
        >>> import torch
        >>> from skinnet.physics import SkinPrior, SkinReflectance, include_specular
        >>> rng = torch.Generator().manual_seed(0)
        >>> f_mel, f_blood, nuisance, leftover = SkinPrior().sample(100, rng)
        >>> skin = SkinReflectance()(f_mel, f_blood, nuisance)
        >>> measured = include_specular(skin) + leftover
        >>> tuple(measured.shape), bool((measured > 0).all())
        ((100, 33), True)
    """

    def __init__(self, record: Mapping[str, Any] | None = None) -> None:
        self.is_shipped = record is None
        record = _read() if record is None else record
        self.weights, self.means, self.covariances = (
            _to_tensor(record["mixture"][name]) for name in ("weights", "means", "covariances")
        )
        self.coefficients, self.nuisance = (
            _to_tensor(record["nuisance"][name]) for name in ("coefficients", "covariances")
        )
        self.tones, self.width = _to_tensor(record["tones"]), float(record["width"])
        self.leftover_means, self.slopes, factors, rest = (
            _to_tensor(record["leftover"][name])
            for name in ("means", "slopes", "factors", "variances")
        )
        self.leftover = factors @ factors.mT + torch.diag_embed(rest)

    def sample(
        self, count: int, rng: torch.Generator
    ) -> tuple[
        Float[Tensor, "count"], Float[Tensor, "count"], Nuisance, Float[Tensor, "count wavelength"]
    ]:
        """Sample skins.

        Args:
            count: Number of skins.
            rng: Random numbers.

        Returns:
            f_mel, f_blood, nuisance, and the measured reflectance (specular included) at each band
            that the model leaves over, to be added to `include_specular` of the model's; float64.
        """
        component = torch.multinomial(self.weights, count, replacement=True, generator=rng)
        pigments = self.means[component] + _sample_normal(self.covariances[component], rng)
        f_mel, f_blood = pigments.exp().clamp(max=1.0).unbind(-1)
        mean, covariance, leftover = self.condition(f_mel, f_blood)
        deviations = torch.stack(list(mean), -1) + _sample_normal(covariance, rng)
        nuisance = Nuisance(*deviations.unbind(-1))
        rest = self.leftover_mean(f_mel, nuisance, f_blood) + _sample_normal(leftover, rng)
        return f_mel, f_blood, nuisance, rest

    def log_prob(
        self,
        f_mel: Float[Tensor, "*#batch"],
        f_blood: Float[Tensor, "*#batch"],
        nuisance: Nuisance,
    ) -> Float[Tensor, "*batch"]:
        """Compute the logarithm of the joint density, for inversion by gradients.

        Args:
            f_mel: Melanosome volume fraction, above 0.
            f_blood: Blood volume fraction, above 0.
            nuisance: Deviations from the preset's constants.

        Returns:
            Density over (ln f_mel, ln f_blood, nuisance), float64.
        """
        mean, covariance, _ = self.condition(f_mel, f_blood)
        parts = torch.broadcast_tensors(*nuisance, *mean)
        deviations = torch.stack(parts[:4], -1) - torch.stack(parts[4:], -1)
        normal = MultivariateNormal(torch.zeros_like(deviations), covariance)
        log_prob: Tensor = normal.log_prob(deviations)
        return self.log_density(f_mel, f_blood) + log_prob

    def log_density(
        self, f_mel: Float[Tensor, "*#batch"], f_blood: Float[Tensor, "*#batch"]
    ) -> Float[Tensor, "*batch"]:
        """Compute the logarithm of the density of both fractions.

        Args:
            f_mel: Melanosome volume fraction, above 0.
            f_blood: Blood volume fraction, above 0.

        Returns:
            Density over (ln f_mel, ln f_blood), float64.
        """
        pigments = torch.stack(torch.broadcast_tensors(f_mel.log(), f_blood.log()), -1)
        mixture = MixtureSameFamily(
            Categorical(self.weights), MultivariateNormal(self.means, self.covariances)
        )
        density: Tensor = mixture.log_prob(pigments.to(self.means.dtype))
        return density

    def condition(
        self, f_mel: Float[Tensor, "*#batch"], f_blood: Float[Tensor, "*#batch"] | None = None
    ) -> tuple[
        Nuisance, Float[Tensor, "*#batch 4 4"], Float[Tensor, "*#batch wavelength wavelength"]
    ]:
        """Compute the distributions of nuisance and of what is left over, given both fractions.

        Args:
            f_mel: Melanosome volume fraction, above 0.
            f_blood: Blood volume fraction, above 0; None: a typical one.

        Returns:
            Mean and covariance of the nuisance, in the order of its fields, and the covariance of
            the measured reflectance that the model leaves over about `leftover_mean`.
        """
        near = self._weigh_tones(f_mel)
        nuisance = torch.einsum("...t,tij->...ij", near, self.nuisance)
        leftover = torch.einsum("...t,tij->...ij", near, self.leftover)
        return Nuisance(*self._regress(f_mel, f_blood).unbind(-1)), nuisance, leftover

    def leftover_mean(
        self,
        f_mel: Float[Tensor, "*#batch"],
        nuisance: Nuisance,
        f_blood: Float[Tensor, "*#batch"] | None = None,
    ) -> Float[Tensor, "*batch wavelength"]:
        """Compute the mean of what the model leaves over, to be added to what it predicts.

        Args:
            f_mel: Melanosome volume fraction, above 0.
            nuisance: Deviations from the preset's constants.
            f_blood: Blood volume fraction, above 0; None: a typical one.

        Returns:
            Measured reflectance (specular included) less that of the model, float64.
        """
        deviations = torch.stack(torch.broadcast_tensors(*nuisance), -1)
        deviations = deviations - self._regress(f_mel, f_blood)
        mean = self._weigh_tones(f_mel) @ self.leftover_means + deviations @ self.slopes[:4]
        if f_blood is None:
            return mean
        blood = (f_blood.to(self.means.dtype) / TYPICAL_F_BLOOD).log()
        return mean + blood[..., None] * self.slopes[4]

    def _weigh_tones(self, f_mel: Float[Tensor, "*batch"]) -> Float[Tensor, "*batch tone"]:
        tone = f_mel.to(self.means.dtype).log()
        return torch.softmax(-0.5 * ((tone[..., None] - self.tones) / self.width) ** 2, -1)

    def _regress(
        self, f_mel: Float[Tensor, "*#batch"], f_blood: Float[Tensor, "*#batch"] | None
    ) -> Float[Tensor, "*batch 4"]:
        tone = (f_mel.to(self.means.dtype) / TYPICAL_F_MEL).log()
        blood = torch.zeros_like(tone)
        if f_blood is not None:
            blood = (f_blood.to(self.means.dtype) / TYPICAL_F_BLOOD).log()
        design = torch.broadcast_tensors(torch.ones_like(tone), tone, blood)
        return torch.stack(design, -1) @ self.coefficients

    @staticmethod
    def typical_nuisance(f_blood: Float[Tensor, "*batch"]) -> Nuisance:
        """Return the nuisance with which two fractions describe measured spectra best.

        Thickness is tied to blood, d = d_pd (f_blood / .03)^1.5: spectra differ most along this
        direction. It says how people, sites of the body and instruments differ. It is not what more
        blood does to a skin, whose thickness stays.

        Args:
            f_blood: Blood volume fraction, above 0.

        Returns:
            The thickness; all else is the preset's.

        Raises:
            InputError: For a fraction that is not above 0.

        Example:
            >>> import torch
            >>> from skinnet.physics import SkinPrior
            >>> SkinPrior.typical_nuisance(torch.tensor(0.03)).thickness.item()
            0.0
        """
        if not (f_blood.detach() > 0).all():
            raise InputError(
                f"f_blood is a volume fraction above 0; got {float(f_blood.detach().min()):g}. "
                "Skin without blood has no typical thickness."
            )
        thickness = _DEPTH_EXPONENT * (f_blood / _REFERENCE_F_BLOOD).log()
        zero = torch.zeros_like(thickness)
        return Nuisance(thickness, zero, zero, zero)


def _to_tensor(values: Any) -> Tensor:
    return torch.tensor(values, dtype=torch.float64)


def _sample_normal(
    covariance: Float[Tensor, "count size size"], rng: torch.Generator
) -> Float[Tensor, "count size"]:
    shape = covariance.shape[:-1]
    normal = torch.randn(shape, generator=rng, dtype=covariance.dtype, device=rng.device)
    root: Tensor = torch.linalg.cholesky(covariance)
    return (root @ normal[..., None])[..., 0]


@cache
def _read() -> dict[str, Any]:
    path = files("skinnet.physics") / "tables" / "prior.json"
    record: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
    return record
