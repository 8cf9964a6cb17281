"""Losses of the autoencoder, each a mean over the photographs of a batch.

The loss of a photograph does not depend on the other photographs. So the loss of a batch is the
mean of the losses of its equal parts, and processes that share a batch have the loss of the whole.

Images are linear sRGB [batch, 3, height, width], maps are [batch, height, width], and a mask holds
the probability that a pixel is skin.
"""

from skinnet.network._means import (
    Image,
    Map,
    Scalar,
    cube_root,
    log_fraction,
    log_mean,
    normal_score,
    weighted_mean,
)
from skinnet.network.autoencoder import F_BLOOD_MAX, F_MEL_MAX, SkinMaps, Uncertainty
from skinnet.network.priors import WHITE_BALANCE_SD
from skinnet.physics.capture import Capture

PIGMENT_SD = 0.066, 0.024
"""Standard deviations of melanin and hemoglobin over the skin of the synthetic faces."""

MEAN_SHADING = 0.85
"""Mean shading of the skin of the synthetic faces."""

_FAINT = 1e-4
"""Added to specular reflection: the derivative of a square root is infinite at zero."""


def appearance_l1(reconstruction: Image, photograph: Image, weight: Map) -> Scalar:
    """Compute the weighted mean absolute difference of two images.

    Saturated pixels are not penalised for being predicted brighter.

    Args:
        reconstruction: Linear sRGB, not clipped.
        photograph: Linear sRGB in [0, 1]; a channel at 1 is saturated.
        weight: Weight of each pixel: the mask for the loss of skin, one minus the mask for that of
            the background.

    Returns:
        Mean of |reconstruction - photograph| over channels and weighted pixels.

    Example:
        >>> import torch
        >>> from skinnet.network import appearance_l1
        >>> dark, weight = torch.zeros(1, 3, 4, 4), torch.ones(1, 4, 4)
        >>> appearance_l1(dark + 0.25, dark, weight).item()
        0.25
        >>> appearance_l1(dark + 2, dark + 1, weight).item()
        0.0
    """
    saturated = (photograph >= 1) & (reconstruction > photograph)
    difference = (reconstruction - photograph).abs().masked_fill(saturated, 0)
    return weighted_mean(difference.mean(1), weight)


def mask_cross_entropy(maps: SkinMaps, mask: Map) -> Scalar:
    """Compute the cross entropy of the skin mask.

    Args:
        maps: Predicted maps.
        mask: Probability of skin.

    Returns:
        Mean of -(m log p + (1 - m) log(1 - p)).

    Example:
        >>> import torch
        >>> from skinnet.network import SkinMaps, mask_cross_entropy
        >>> values = torch.full((4, 1, 8, 8), 0.05)
        >>> mask = torch.ones(1, 8, 8)
        >>> maps = SkinMaps(*values, torch.zeros(1, 3, 8, 8), mask)
        >>> round(mask_cross_entropy(maps, mask).item(), 4)
        0.0
    """
    # torch's own function raises an error for NaN; on a GPU it ends the process.
    skin = maps.mask.clamp(1e-6, 1 - 1e-6)
    return -(mask * skin.log() + (1 - mask) * (1 - skin).log()).mean()


def soft_iou(maps: SkinMaps, mask: Map) -> Scalar:
    """Compute one minus the soft intersection over union (Jaccard index) of the skin mask.

    Cross entropy alone leaves thin beards and loose hair near one half on either side.

    Args:
        maps: Predicted maps.
        mask: Probability of skin; a pixel above one half is skin.

    Returns:
        1 - (sum(p m) + 1) / (sum(p + m - p m) + 1), for prediction p and skin m. The added pixel
        makes the loss 0 for a prediction without skin on a photograph without skin.

    Source:
        Rahman & Wang 2016, "Optimizing Intersection-Over-Union in Deep Neural Networks".

    Example:
        >>> import torch
        >>> from skinnet.network import SkinMaps, soft_iou
        >>> values = torch.full((4, 1, 8, 8), 0.05)
        >>> mask = torch.ones(1, 8, 8)
        >>> maps = SkinMaps(*values, torch.zeros(1, 3, 8, 8), mask)
        >>> soft_iou(maps, mask).item()
        0.0
    """
    skin, over = (mask > 0.5).to(mask), (-2, -1)
    intersection = (maps.mask * skin).sum(over)
    union = (maps.mask + skin).sum(over) - intersection
    return (1 - (intersection + 1) / (union + 1)).mean()


def pigment_l1(maps: SkinMaps, truth: SkinMaps) -> Scalar:
    """Compute the mean absolute error of both pigments on true skin, in cube roots.

    Equal steps of the cube root are about equal steps of colour. In plain fractions, only dark skin
    would count.

    Args:
        maps: Predicted maps.
        truth: True maps and mask.

    Returns:
        Weighted mean of |d m^(1/3)| + |d b^(1/3)|, for melanin m and blood b relative to their
        largest fractions.

    Example:
        >>> import torch
        >>> from skinnet.network import F_MEL_MAX, SkinMaps, pigment_l1
        >>> values = torch.full((4, 1, 8, 8), 0.05)
        >>> mask = torch.ones(1, 8, 8)
        >>> maps = SkinMaps(*values, torch.zeros(1, 3, 8, 8), mask)
        >>> truth = maps._replace(melanin=8 * maps.melanin)  # twice the cube root
        >>> round(pigment_l1(maps, truth).item(), 4), round((0.05 / F_MEL_MAX) ** (1 / 3), 4)
        (0.4881, 0.4881)
    """
    melanin = cube_root(maps.melanin, F_MEL_MAX) - cube_root(truth.melanin, F_MEL_MAX)
    blood = cube_root(maps.hemoglobin, F_BLOOD_MAX) - cube_root(truth.hemoglobin, F_BLOOD_MAX)
    return weighted_mean(melanin.abs() + blood.abs(), truth.mask)


def pigment_mse(maps: SkinMaps, truth: SkinMaps) -> Scalar:
    """Compute the mean squared error of both pigments on true skin, in standard deviations.

    `pigment_l1` measures typical errors and all skin alike. This loss measures the largest errors,
    which are those of dark skin and of much blood.

    Args:
        maps: Predicted maps.
        truth: True maps and mask.

    Returns:
        Weighted mean of ((m - m*) / 0.066)^2 + ((b - b*) / 0.024)^2, for melanin m and blood b.

    Example:
        >>> import torch
        >>> from skinnet.network import SkinMaps, pigment_mse
        >>> from skinnet.network.losses import PIGMENT_SD
        >>> values = torch.full((4, 1, 8, 8), 0.05)
        >>> mask = torch.ones(1, 8, 8)
        >>> maps = SkinMaps(*values, torch.zeros(1, 3, 8, 8), mask)
        >>> truth = maps._replace(melanin=maps.melanin + 2 * PIGMENT_SD[0])
        >>> round(pigment_mse(maps, truth).item(), 4)
        4.0
    """
    melanin, blood = (
        ((guess - true) / deviation) ** 2
        for guess, true, deviation in zip(maps[:2], truth[:2], PIGMENT_SD, strict=True)
    )
    return weighted_mean(melanin + blood, truth.mask)


def error_shading_covariance(maps: SkinMaps, truth: SkinMaps) -> Scalar:
    """Compute minus the covariance of melanin's error with the true shading.

    Pale skin in little light looks like dark skin in strong light. The best guess between the two
    has too little melanin where the light is strong, so its error falls with shading. The weight
    of this loss is the Lagrange multiplier of the constraint that errors do not depend on shading.
    Too large a weight reverses the sign of the covariance. From 7/8 of the weight of `pigment_l1`
    on, the sum of both losses has no minimum.

    Args:
        maps: Predicted maps.
        truth: True maps and mask.

    Returns:
        -mean(e (min(s, 2) - 0.85)), for the error e of the cube root of melanin and shading s; 0.85
        is the mean of shading.

    Example:
        >>> import torch
        >>> from skinnet.network import SkinMaps, error_shading_covariance
        >>> values = torch.full((4, 1, 8, 8), 0.05)
        >>> mask = torch.ones(1, 8, 8)
        >>> maps = SkinMaps(*values, torch.zeros(1, 3, 8, 8), mask)
        >>> bright = maps._replace(melanin=8 * maps.melanin, shading=2 * mask)
        >>> round(error_shading_covariance(maps, bright).item(), 4)  # .4881 times 1.15
        0.5613
    """
    error = cube_root(maps.melanin, F_MEL_MAX) - cube_root(truth.melanin, F_MEL_MAX)
    return -weighted_mean(error * (truth.shading.clamp_max(2) - MEAN_SHADING), truth.mask)


def lighting_error(maps: SkinMaps, truth: SkinMaps) -> Scalar:
    """Compute the absolute error of shading plus ten times the squared error of root specular.

    Most skin has hardly any specular reflection. An absolute error would be smallest for a
    prediction without any.

    Args:
        maps: Predicted maps.
        truth: True maps.

    Returns:
        Mean of |s - s*| + 10 (sqrt(g) - sqrt(g*))^2, for shading s and specular reflection g.

    Example:
        >>> import torch
        >>> from skinnet.network import SkinMaps, lighting_error
        >>> values = torch.full((4, 1, 8, 8), 0.05)
        >>> mask = torch.ones(1, 8, 8)
        >>> maps = SkinMaps(*values, torch.zeros(1, 3, 8, 8), mask)
        >>> truth = maps._replace(shading=maps.shading + 0.5)
        >>> round(lighting_error(maps, truth).item(), 4)
        0.5
    """
    specular = (maps.specular + _FAINT).sqrt() - (truth.specular + _FAINT).sqrt()
    return (10 * specular**2 + (maps.shading - truth.shading).abs()).mean()


def white_balance_l1(capture: Capture, truth: Capture) -> Scalar:
    """Compute the mean absolute error of the white balance, in standard deviations.

    Args:
        capture: Predicted capture.
        truth: The true capture.

    Returns:
        Mean of |w - w*| / 0.05, for log R/G and log B/G.

    Example:
        >>> import torch
        >>> from skinnet.network import white_balance_l1
        >>> from skinnet.physics import SpectralCamera
        >>> perfect = SpectralCamera().standard((1,))
        >>> other = perfect._replace(white_balance=torch.full((1, 2), 0.05))
        >>> white_balance_l1(other, perfect).item()
        1.0
    """
    return (capture.white_balance - truth.white_balance).abs().mean() / WHITE_BALANCE_SD


def pigment_likelihood(maps: SkinMaps, uncertainty: Uncertainty, truth: SkinMaps) -> Scalar:
    """Compute the negative log likelihood of both pigments' errors under the stated uncertainty.

    The errors of the natural logarithms are normal, for each pixel of skin and for the mean over
    the skin of a photograph. Only the uncertainty has a gradient: with the maps in it, hard
    photographs would count less for them.

    Args:
        maps: Predicted maps.
        uncertainty: Predicted standard deviations.
        truth: True maps and mask.

    Returns:
        Mean over photographs and both pigments of log d + (e / d)^2 / 2, for error e and standard
        deviation d, of pixels plus of faces.

    Source:
        Gneiting & Raftery 2007, "Strictly Proper Scoring Rules", section 4.1 (logarithmic score).

    Example:
        >>> import torch
        >>> from skinnet.network import SkinMaps, Uncertainty, pigment_likelihood
        >>> values = torch.full((4, 1, 8, 8), 0.05)
        >>> mask = torch.ones(1, 8, 8)
        >>> maps = SkinMaps(*values, torch.zeros(1, 3, 8, 8), mask)
        >>> certain = Uncertainty(mask, mask, torch.ones(1, 2))
        >>> pigment_likelihood(maps, certain, maps).item()
        0.0
    """
    spreads = uncertainty.melanin, uncertainty.hemoglobin
    faces = uncertainty.face.unbind(-1)
    shown = (truth.mask.sum((-2, -1)) > 1).to(truth.mask)
    total = truth.mask.new_zeros(())
    for guess, true, pixel, face in zip(maps[:2], truth[:2], spreads, faces, strict=True):
        guess = guess.detach()
        error = log_fraction(guess) - log_fraction(true)
        total = total + weighted_mean(normal_score(error, pixel**2), truth.mask)
        error = log_mean(guess, truth.mask) - log_mean(true, truth.mask)
        total = total + (normal_score(error, face**2) * shown).mean()
    return total / 2
