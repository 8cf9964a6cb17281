"""Melanin and blood with their uncertainty."""

from typing import NamedTuple

from jaxtyping import Bool, Float
from torch import Tensor


class Posterior(NamedTuple):
    """What a colour says about melanin and blood, and how much it adds to `SkinPrior`.

    A gain is a variance reduction: 1 minus the variance of ln f given the colour over its variance
    in the prior. It is 0 where the colour says nothing and 1 where it says all; numerically it may
    be slightly negative. The prior of blood is that of skins with the melanin that the colour
    shows. The posterior is approximately log-normal.

    A colour that is NaN or infinite, or that no skin has, gives NaN. Grey is a colour that some
    skin may have: `is_skin` does not segment a picture.

    Attributes:
        f_mel: Mean of the melanosome volume fraction.
        f_blood: Mean of the blood volume fraction.
        f_mel_sd: Standard deviation of f_mel.
        f_blood_sd: Standard deviation of f_blood.
        f_mel_gain: Share of the prior's variance of ln f_mel that the colour removes, at most 1.
        f_blood_gain: The same for ln f_blood, given melanin.
        mel_is_prior: Whether f_mel is little more than the prior's mean: its gain is below .25, so
            that the colour lowers the standard deviation by less than 13 %.
        blood_is_prior: The same for f_blood.
        is_skin: Whether the colour lies within five standard deviations of a skin of the prior, and
            its mean melanin is at most .5.
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
