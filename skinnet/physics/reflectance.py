"""Spectral reflectance of skin from two pigment fractions (sections 3.2 to 3.5 of the paper)."""

from dataclasses import fields

import torch
from jaxtyping import Float
from torch import Tensor, nn

from skinnet.physics._parameters import check_fraction, check_nuisance, register_constant
from skinnet.physics.nuisance import Nuisance
from skinnet.physics.optics import SkinOptics
from skinnet.physics.spectra import WAVELENGTHS


class SkinReflectance(nn.Module):
    """Two-layer skin: a Lambert-Beer epidermis over a Kubelka-Munk dermis.

    R_total = T_epidermis(f_mel)^2 R_dermis(f_blood) at the 33 bands of `WAVELENGTHS`.

    The model differs from the printed equations in three ways. The baseline absorption of the
    epidermis is multiplied by its thickness, because an exponent has no dimension. The denominator
    of R_dermis is Kubelka-Munk's; the printed one gives R = 1 without absorption. Blood is packed
    into vessels and melanin into packets of radius r, mu -> mu (1 - exp(-2 mu r)) / (2 mu r);
    without it two parameters do not explain skin.

    Args:
        optics: Constants, or the name of a preset. One that is an `nn.Parameter` is a parameter
            here; the others are buffers.
        dtype: Precision of the buffers; None: torch's default.

    Source:
        Equations 2 and 3 of Alotaibi & Smith 2017, sections 3.2 to 3.5. Pigment packaging: Duysens
        1956; van Veen et al. 2002.

    Example:
        >>> import torch
        >>> from skinnet.physics import SkinReflectance
        >>> skin = SkinReflectance()
        >>> pale, dark = skin(torch.tensor([0.02, 0.2]), 0.04)
        >>> tuple(pale.shape), bool((dark < pale).all())
        ((33,), True)
    """

    wavelengths: Tensor
    c_eum: Tensor
    c_phm: Tensor
    f_eum: Tensor
    c_hem: Tensor
    g: Tensor
    f_oxy: Tensor
    d_epd: Tensor
    d_pd: Tensor
    d_base: Tensor | None
    r_vessel: Tensor
    r_melanin: Tensor
    blood_epd: Tensor
    base_floor: Tensor
    base_scale: Tensor
    mie: Tensor
    rayleigh: Tensor
    eps_eum: Tensor
    eps_phm: Tensor
    e_oxy: Tensor
    e_deoxy: Tensor

    def __init__(
        self, optics: SkinOptics | str = "measured", dtype: torch.dtype | None = None
    ) -> None:
        super().__init__()
        optics = SkinOptics.preset(optics) if isinstance(optics, str) else optics
        dtype = dtype or torch.get_default_dtype()
        self.dermis = optics.dermis
        register_constant(self, "wavelengths", WAVELENGTHS, dtype, persistent=False)
        for item in fields(optics):
            if "range" in item.metadata:
                register_constant(self, item.name, getattr(optics, item.name), dtype)
        self.register_load_state_dict_pre_hook(_complete_older_state)  # type: ignore[no-untyped-call]

    def forward(
        self,
        f_mel: Float[Tensor, "*#batch"] | float,
        f_blood: Float[Tensor, "*#batch"] | float,
        nuisance: Nuisance | None = None,
    ) -> Float[Tensor, "*batch wavelength"]:
        """Compute reflectance spectra (equation 3).

        Args:
            f_mel: Melanosome volume fraction of the epidermis, in [0, 1].
            f_blood: Blood volume fraction of the dermis, in [0, 1].
            nuisance: Deviations of each skin from the preset's constants; None: none.

        Returns:
            Reflectance in [0, 1] at the 33 bands, in the last axis.

        Raises:
            InputError: For a fraction that is NaN, negative or above one, or a deviation that is
                NaN or larger than any skin's; it is a `ValueError`.
        """
        f_mel = check_fraction("f_mel", f_mel, like=self.wavelengths)
        f_blood = check_fraction("f_blood", f_blood, like=self.wavelengths)
        if nuisance is not None:
            nuisance = check_nuisance(nuisance, like=self.wavelengths)
        return self.bands(f_mel, f_blood, nuisance)

    def bands(
        self,
        f_mel: Float[Tensor, "*#batch"],
        f_blood: Float[Tensor, "*#batch"],
        nuisance: Nuisance | None = None,
    ) -> Float[Tensor, "*batch wavelength"]:
        """Compute `forward` without its checks, for graphs that are trained or exported.

        R_total = T_epidermis^2 R_dermis, section 3.4 of the paper.

        Args:
            f_mel: Melanosome volume fraction.
            f_blood: Blood volume fraction.
            nuisance: Deviations of each skin from the preset's constants; None: none.

        Returns:
            Reflectance at the 33 bands, in the last axis.
        """
        f_mel, f_blood = f_mel[..., None], f_blood[..., None]
        if nuisance is not None:
            nuisance = Nuisance(*(deviation[..., None] for deviation in nuisance))
        epidermis = self.epidermis_transmittance(f_mel, f_blood, nuisance)
        return epidermis**2 * self.dermis_reflectance(f_blood, nuisance)

    def epidermis_transmittance(
        self,
        f_mel: Float[Tensor, "*#batch 1"],
        f_blood: Float[Tensor, "*#batch 1"],
        nuisance: Nuisance | None = None,
    ) -> Float[Tensor, "*batch wavelength"]:
        """Compute the transmittance of the epidermis in one direction (equation 2).

        Only the authors' release has blood in the epidermis, and weights each hemoglobin by its
        share of the total twice.

        Args:
            f_mel: Melanosome volume fraction.
            f_blood: Blood volume fraction.
            nuisance: Deviations from the preset's constants [*#batch, 1]; None: none.

        Returns:
            Transmittance in [0, 1].
        """
        d_base = self.d_epd if self.d_base is None else self.d_base
        f_hem = self.blood_epd * f_blood
        f_oxy = self._oxygenation(nuisance)
        doubly_weighted = f_oxy**2 * self._mu(self.e_oxy) + (1 - f_oxy) ** 2 * self._mu(
            self.e_deoxy
        )
        melanin = f_mel * self.d_epd * self.mu_mel
        mu_base = self._baseline(nuisance)
        return torch.exp(
            -melanin - d_base * (f_hem * doubly_weighted + (1 - f_mel - f_hem) * mu_base)
        )

    def dermis_reflectance(
        self, f_blood: Float[Tensor, "*#batch 1"], nuisance: Nuisance | None = None
    ) -> Float[Tensor, "*batch wavelength"]:
        """Compute the reflectance of the papillary dermis over a black substrate (section 3.3).

        Args:
            f_blood: Blood volume fraction.
            nuisance: Deviations from the preset's constants [*#batch, 1]; None: none.

        Returns:
            Reflectance in [0, 1].
        """
        mu_blood = self._mu_blood(self._oxygenation(nuisance))
        k = f_blood * mu_blood + (1 - f_blood) * self._baseline(nuisance)
        s = self.mie * self.wavelengths**-1.5 + self.rayleigh * self.wavelengths**-4.0
        if nuisance is None:
            return self.dermis(k, s, self.d_pd)
        s, d = s * nuisance.scattering.exp(), self.d_pd * nuisance.thickness.exp()
        return self.dermis(k, s, d)

    @property
    def mu_mel(self) -> Float[Tensor, "wavelength"]:
        """Absorption of melanosomes in packets of radius `r_melanin`, cm^-1 (section 3.2)."""
        eumelanin = self.f_eum * self.eps_eum * self.c_eum
        mu = eumelanin + (1 - self.f_eum) * self.eps_phm * self.c_phm
        return mu * _pigment_packaging(2 * mu * self.r_melanin)

    @property
    def mu_base(self) -> Float[Tensor, "wavelength"]:
        """Absorption of skin without pigment, cm^-1 (section 3.2, Table 2; Jacques 1998)."""
        return self.base_floor + self.base_scale * torch.exp(-(self.wavelengths - 154) / 66.2)

    @property
    def mu_blood(self) -> Float[Tensor, "wavelength"]:
        """Absorption of whole blood in vessels of radius `r_vessel`, cm^-1 (section 3.3)."""
        return self._mu_blood(self.f_oxy)

    def _mu_blood(self, f_oxy: Float[Tensor, "..."]) -> Float[Tensor, "*#batch wavelength"]:
        mu = f_oxy * self._mu(self.e_oxy) + (1 - f_oxy) * self._mu(self.e_deoxy)
        return mu * _pigment_packaging(2 * mu * self.r_vessel)

    def _oxygenation(self, nuisance: Nuisance | None) -> Float[Tensor, "..."]:
        return self.f_oxy if nuisance is None else (self.f_oxy + nuisance.oxygenation).clamp(0, 1)

    def _baseline(self, nuisance: Nuisance | None) -> Float[Tensor, "*#batch wavelength"]:
        return self.mu_base if nuisance is None else self.mu_base * nuisance.baseline.exp()

    def _mu(self, extinction: Float[Tensor, "wavelength"]) -> Float[Tensor, "wavelength"]:
        return 2.303 * extinction * self.c_hem / self.g


def _pigment_packaging(x: Float[Tensor, "*shape"]) -> Float[Tensor, "*shape"]:
    """Return (1 - exp(-x)) / x for x >= 0, smooth at zero, where it is 1 (van Veen et al. 2002)."""
    small = x < 1e-4
    safe = torch.where(small, torch.ones_like(x), x)
    return torch.where(small, 1 - x / 2 + x**2 / 6, -torch.expm1(-safe) / safe)


def _complete_older_state(
    module: nn.Module, state: dict[str, Tensor], prefix: str, *_: object
) -> None:
    """Give a state that was saved before melanin was packed a radius of 0."""
    if f"{prefix}d_epd" in state:
        state.setdefault(f"{prefix}r_melanin", torch.zeros_like(state[f"{prefix}d_epd"]))
