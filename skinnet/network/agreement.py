"""Losses of photographs of the same people, whose pigments are unknown but the same in both.

The second half of a batch shows the people of the first half in other photographs. Maps are
[batch, height, width], and a mask holds the probability that a pixel is skin.
"""

import torch
from jaxtyping import Bool, Float, Int64
from torch import Tensor
from torch.distributions import StudentT

from skinnet.network._means import Map, Scalar, cube_root, log_mean, mean_over, normal_score
from skinnet.network.autoencoder import F_BLOOD_MAX, F_MEL_MAX, SkinMaps, Uncertainty
from skinnet.physics.decoder import SkinDecoder
from skinnet.physics.srgb import luminance

_LEAST_PIXELS = 20

_FAINT = 1e-5
"""Variance of cube roots that is no difference between people."""

_DARKEST = 1e-3
_FREEDOM = 4.0
"""Degrees of freedom of the colours' distribution: paintings and failures are far out."""


def region_agreement(
    maps: SkinMaps, regions: Int64[Tensor, "batch height width"], mask: Map
) -> Scalar:
    """Compare a face and its regions in two photographs, relative to how much people differ.

    Args:
        maps: Predicted maps.
        regions: Number of the region of each pixel, from 1; 0 is none.
        mask: Probability of skin.

    Returns:
        Mean of log(1 + d^2 / v) over the whole skin, all regions and both pigments, for differences
        d of mean cube roots and their variance v over all photographs of the batch. d^2 / v tends
        to 1 - ICC (one minus the intraclass correlation), and does not fall when all differences
        between people shrink. The logarithm is that of a Cauchy likelihood: photographs that cannot
        agree, such as paintings, count little.

    Example:
        >>> import torch
        >>> from skinnet.network import SkinMaps, region_agreement
        >>> values, mask = torch.full((4, 2, 8, 8), 0.05), torch.ones(2, 8, 8)
        >>> maps = SkinMaps(*values, torch.zeros(2, 3, 8, 8), mask)
        >>> region_agreement(maps, torch.ones(2, 8, 8, dtype=torch.long), mask).item()
        0.0
    """
    count = max(int(regions.max()), 1)
    parts = [(regions == number) * mask for number in range(1, count + 1)]
    weight = torch.stack([mask, *parts], 1)
    pixels = weight.sum((-2, -1))
    seen = torch.stack(pixels.chunk(2)).amin(0) > _LEAST_PIXELS
    total = mask.new_zeros(())
    for fraction, largest in ((maps.melanin, F_MEL_MAX), (maps.hemoglobin, F_BLOOD_MAX)):
        root = cube_root(fraction, largest)[:, None]
        mean = (root * weight).sum((-2, -1)) / pixels.clamp_min(1)
        first, second = mean.chunk(2)
        ratio = (first - second) ** 2 / (_measure_variance(mean, seen.repeat(2, 1)) + _FAINT)
        total = total + (ratio.log1p() * seen).sum() / seen.sum().clamp_min(1)
    return total / 2


def _measure_variance(
    values: Float[Tensor, "batch regions"], seen: Bool[Tensor, "batch regions"]
) -> Float[Tensor, "regions"]:
    """Variance over the photographs in which a region is seen."""
    count = seen.sum(0).clamp_min(2)
    mean = (values * seen).sum(0) / count
    return ((values - mean) ** 2 * seen).sum(0) / (count - 1)


def colour_prediction(
    maps: SkinMaps,
    mask: Map,
    colour: Float[Tensor, "batch 3"],
    decoder: SkinDecoder,
    shift: Float[Tensor, "3"],
    log_scale: Float[Tensor, "3"],
) -> Scalar:
    """Score how well the skin that is read predicts its colour in the other photograph.

    The colour of a person in another photograph is an unbiased and noisy label of the person's own,
    so that this tends to the person's colour. It cannot collapse, whereas agreement alone is best
    when all people are the same.

    Args:
        maps: Predicted maps.
        mask: Probability of skin.
        colour: Log R/G, log B/G and log luminance of the skin in each photograph.
        decoder: Renders the mean pigments under D65.
        shift: What the mean capture adds to that colour.
        log_scale: Natural logarithm of the spread of captures.

    Returns:
        Mean negative log likelihood under Student's distribution with four degrees of freedom.

    Example:
        >>> import torch
        >>> from skinnet.network import SkinMaps, colour_prediction
        >>> from skinnet.physics import SkinDecoder
        >>> values, mask = torch.full((4, 2, 8, 8), 0.05), torch.ones(2, 8, 8)
        >>> maps = SkinMaps(*values, torch.zeros(2, 3, 8, 8), mask)
        >>> colour = torch.tensor([0.8, -0.5, -1.8]).expand(2, 3)
        >>> colour_prediction(maps, mask, colour, SkinDecoder(), *torch.zeros(2, 3)) < 1.5
        tensor(True)
    """
    own = measure_skin_colour(maps, mask, decoder) + shift
    other = torch.cat(colour.chunk(2)[::-1])
    # Not validated: training says in words which loss is not finite.
    captures = StudentT(_FREEDOM, own, log_scale.exp(), validate_args=False)
    score: Tensor = -captures.log_prob(other)
    return score.mean()


def measure_skin_colour(
    maps: SkinMaps, mask: Map, decoder: SkinDecoder
) -> Float[Tensor, "batch 3"]:
    """Measure the colour of the mean pigments under D65 and the mean camera.

    Args:
        maps: Predicted maps.
        mask: Probability of skin.
        decoder: Renders the mean pigments.

    Returns:
        Log R/G, log B/G and log luminance of the albedo in linear sRGB.

    Example:
        >>> import torch
        >>> from skinnet.network import SkinMaps, measure_skin_colour
        >>> from skinnet.physics import SkinDecoder
        >>> values, mask = torch.full((4, 1, 8, 8), 0.05), torch.ones(1, 8, 8)
        >>> maps = SkinMaps(*values, torch.zeros(1, 3, 8, 8), mask)
        >>> red, blue, _ = measure_skin_colour(maps, mask, SkinDecoder())[0].tolist()
        >>> red > 0 > blue
        True
    """
    melanin, blood = (mean_over(one, mask)[:, None, None] for one in maps[:2])
    matrix = decoder.camera.matrix(decoder.camera.standard((len(melanin),)))
    albedo = decoder.albedo(melanin, blood, matrix).clamp_min(_DARKEST)
    red, green, blue = albedo[..., 0, 0].log().unbind(-1)
    return torch.stack([red - green, blue - green, luminance(albedo)[:, 0, 0, 0].log()], -1)


def agreement_likelihood(maps: SkinMaps, uncertainty: Uncertainty, mask: Map) -> Scalar:
    """Score the stated uncertainty of faces by the differences between two photographs.

    The difference of two log means has the sum of both variances. Only the uncertainty has a
    gradient.

    Args:
        maps: Predicted maps.
        uncertainty: Predicted standard deviations.
        mask: Probability of skin.

    Returns:
        Mean over people and both pigments of log(v) / 2 + d^2 / 2 v, for differences d and the
        sum v of both variances.

    Example:
        >>> import torch
        >>> from skinnet.network import SkinMaps, Uncertainty, agreement_likelihood
        >>> values, mask = torch.full((4, 2, 8, 8), 0.05), torch.ones(2, 8, 8)
        >>> maps = SkinMaps(*values, torch.zeros(2, 3, 8, 8), mask)
        >>> certain = Uncertainty(mask, mask, torch.full((2, 2), 0.5**0.5))
        >>> abs(agreement_likelihood(maps, certain, mask).item()) < 1e-6
        True
    """
    logs = [log_mean(one.detach(), mask) for one in maps[:2]]
    first, second = torch.stack(logs, -1).chunk(2)
    variance = torch.stack((uncertainty.face**2).chunk(2)).sum(0)
    return normal_score(first - second, variance).mean()
