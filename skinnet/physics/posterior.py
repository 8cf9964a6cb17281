"""Melanin and blood with their uncertainty."""

from typing import NamedTuple

from jaxtyping import Bool, Float
from torch import Tensor


class Posterior(NamedTuple):
    """What a colour says about melanin and blood, and how much more than `SkinPrior` says.

    A gain is 1 less the variance of ln f given the colour over its variance in the prior: 0 where
    the colour says nothing, 1 where it says all. The prior of blood is that of skins with the
    melanin that the colour shows. The posterior is about log-normal.

    A colour that is NaN or infinite, or is no skin's, gives NaN.

    Attributes:
        f_mel: Mean of the melanosome volume fraction.
        f_blood: Mean of the blood volume fraction.
        f_mel_sd: Standard deviation of f_mel.
        f_blood_sd: Standard deviation of f_blood.
        f_mel_gain: Share of the prior's variance of ln f_mel that the colour removes, at most 1.
        f_blood_gain: The same of ln f_blood, given melanin.
        mel_is_prior: Whether f_mel is little more than the prior's: its gain is below .25, so the
            colour lowers the standard deviation by less than 13 %, and among skins with the same
            prior the mean correlates with the truth by less than one half.
        blood_is_prior: The same of f_blood.
        is_skin: Whether a skin of the prior has a colour within five standard deviations.
    """

    f_mel: Float[Tensor, "*shape"]
    f_blood: Float[Tensor, "*shape"]
    f_mel_sd: Float[Tensor, "*shape"]
    f_blood_sd: Float[Tensor, "*shape"]
    f_mel_gain: Float[Tensor, "*shape"]
    f_blood_gain: Float[Tensor, "*shape"]
    mel_is_prior: Bool[Tensor, "*shape"]
    blood_is_prior: Bool[Tensor, "*shape"]
    is_skin: Bool[Tensor, "*shape"]
