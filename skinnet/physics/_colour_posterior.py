"""Posteriors of colours under one light and camera, from tables that are kept."""

import torch
from jaxtyping import Bool, Float, Shaped
from torch import Tensor

from skinnet.errors import InputError
from skinnet.physics._posterior_nodes import tabulate_nodes
from skinnet.physics._posterior_table import REACH, PosteriorTable
from skinnet.physics.posterior import Posterior
from skinnet.physics.prior import SkinPrior
from skinnet.physics.reflectance import SkinReflectance

_MAX_COLOUR = 1e6
"""A colour with a larger value gives NaN, as does one that is NaN."""

_LEAST_GAIN = 0.25
"""Gain below which a posterior is called the prior: a correlation of one half."""

_MAX_DEVIATION, _TABLES = 0.5, 4
"""Largest standard deviation of noise and of white balance, and number of tables that are kept."""


_MOST_MELANIN = 0.5
"""Mean melanin beyond which a colour is no skin's. The darkest measured skins have .43. Black, such
as the border of a masked picture, has more."""


class ColourPosteriors:
    """Posteriors of a skin's colours, for any noise and white balance.

    `reflectance` and `matrix` are in float64 on the CPU.
    """

    def __init__(self, reflectance: SkinReflectance, matrix: Float[Tensor, "wavelength 3"]) -> None:
        self._reflectance, self._matrix = reflectance, matrix
        self._tables: list[tuple[float, float, SkinPrior | None, PosteriorTable]] = []

    @torch.no_grad()
    def __call__(
        self,
        rgb: Shaped[Tensor, "*shape channels"],
        noise: float,
        white_balance: float,
        prior: SkinPrior | None,
    ) -> Posterior:
        """Compute the posterior of colours, in their precision and on their device."""
        flat, usable = flatten_colours(rgb)
        for name, value in (("noise", noise), ("white_balance", white_balance)):
            _check_deviation(name, value)
        table = self.tabulate(noise, white_balance, prior)
        found = table(flat if usable.all() else torch.where(usable[:, None], flat, 0.0))
        is_skin = usable & (found[6] <= REACH) & (found[0] <= _MOST_MELANIN)
        found[:, ~is_skin] = torch.nan
        values = [row.to(rgb.device, flat.dtype).reshape(rgb.shape[:-1]) for row in found]
        f_mel, f_mel_sd, f_mel_gain, f_blood, f_blood_sd, f_blood_gain, _ = values
        return Posterior(
            f_mel=f_mel,
            f_blood=f_blood,
            f_mel_sd=f_mel_sd,
            f_blood_sd=f_blood_sd,
            f_mel_gain=f_mel_gain,
            f_blood_gain=f_blood_gain,
            mel_is_prior=f_mel_gain < _LEAST_GAIN,
            blood_is_prior=f_blood_gain < _LEAST_GAIN,
            is_skin=is_skin.to(rgb.device).reshape(rgb.shape[:-1]),
        )

    def tabulate(
        self, noise: float, white_balance: float, prior: SkinPrior | None
    ) -> PosteriorTable:
        """Return the table of an earlier call with the same arguments, or a new one."""
        for *deviations, other, table in self._tables:
            if deviations == [noise, white_balance] and other is prior:
                return table
        if prior is None or prior.is_shipped:
            _check_constants(self._reflectance)
        some = SkinPrior() if prior is None else prior
        nodes = tabulate_nodes(self._reflectance, self._matrix, some, noise, white_balance)
        table = PosteriorTable(nodes)
        self._tables = [*self._tables[1 - _TABLES :], (noise, white_balance, prior, table)]
        return table


def flatten_colours(
    rgb: Shaped[Tensor, "*shape channels"],
) -> tuple[Float[Tensor, "colours 3"], Bool[Tensor, "colours"]]:
    """Return colours on the CPU, in float32 at least, and which of them are finite and plausible.

    Raises:
        InputError: Unless the last axis holds R, G and B in floating point.
    """
    if rgb.ndim == 0 or rgb.shape[-1] != 3 or not rgb.is_floating_point():
        raise InputError(
            f"Colours are linear RGB in floating point, with R, G and B in the last axis; got "
            f"{rgb.dtype} of shape {tuple(rgb.shape)}."
        )
    dtype = torch.promote_types(rgb.dtype, torch.float32)
    flat = rgb.detach().to("cpu", dtype).reshape(-1, 3)
    return flat, (flat.abs() < _MAX_COLOUR).all(1)


def _check_deviation(name: str, value: float) -> None:
    if not 0 <= value <= _MAX_DEVIATION:
        raise InputError(
            f"{name} is a standard deviation in [0, {_MAX_DEVIATION:g}]; got {value:g}. Was it "
            "given in percent, or in steps of 8 bits?"
        )


def _check_constants(reflectance: SkinReflectance) -> None:
    """Refuse a skin that is not the one whose fits to measured spectra made the prior."""
    measured = SkinReflectance("measured", dtype=torch.float64).state_dict()
    own = reflectance.state_dict()
    other = [
        name
        for name in sorted(measured.keys() | own.keys())
        if name not in own
        or name not in measured
        or not torch.allclose(own[name], measured[name], rtol=1e-5, atol=0)
    ]
    if other:
        raise InputError(
            "SkinPrior is the distribution of skins with the constants of the preset `measured`; "
            f"this skin differs in {', '.join(other)}. Use that preset, or hand in a prior that "
            "was fitted with these constants."
        )
