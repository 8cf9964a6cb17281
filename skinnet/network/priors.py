"""Priors of photographs without known pigments, each a mean over the photographs of a batch.

Maps are [batch, height, width], and a mask holds the probability that a pixel is skin.
"""

from kornia.filters import gaussian_blur2d, spatial_gradient

from skinnet.network._means import Image, Map, Scalar, cube_root, weighted_mean
from skinnet.network.autoencoder import F_BLOOD_MAX, F_MEL_MAX, SkinMaps
from skinnet.physics.capture import Capture
from skinnet.physics.srgb import luminance

WHITE_BALANCE_SD = 0.05
"""Standard deviation of a camera's white-balance errors in log R/G and log B/G."""

_DARKEST = 1e-3


def camera_prior(capture: Capture) -> Scalar:
    """Compute the negative log likelihood of camera and white balance under normal priors.

    Args:
        capture: Camera coefficients in standard deviations, and white balance in logarithms.

    Returns:
        mean(b^2) / 2 + mean((w / 0.05)^2) / 2, for coefficients b and white-balance errors w.

    Example:
        >>> from skinnet.network import camera_prior
        >>> from skinnet.physics import SpectralCamera
        >>> camera_prior(SpectralCamera().standard((1,))).item()
        0.0
    """
    balance = (capture.white_balance / WHITE_BALANCE_SD) ** 2
    return (capture.camera**2).mean() / 2 + balance.mean() / 2


def specular_sparsity(maps: SkinMaps, mask: Map) -> Scalar:
    """Compute the mean specular reflection on skin.

    This is an L1 prior: highlights are rare, not absent.

    Args:
        maps: Predicted maps.
        mask: Probability of skin.

    Returns:
        Weighted mean of the specular map.

    Example:
        >>> import torch
        >>> from skinnet.network import SkinMaps, specular_sparsity
        >>> values = torch.full((4, 1, 8, 8), 0.05)
        >>> mask = torch.ones(1, 8, 8)
        >>> maps = SkinMaps(*values, torch.zeros(1, 3, 8, 8), mask)
        >>> round(specular_sparsity(maps, mask).item(), 4)
        0.05
    """
    return weighted_mean(maps.specular, mask)


def shading_smoothness(maps: SkinMaps, mask: Map) -> Scalar:
    """Compute the mean absolute gradient of log shading on skin.

    Args:
        maps: Predicted maps.
        mask: Probability of skin.

    Returns:
        Weighted mean of |d log s / dx| + |d log s / dy|, per pixel.

    Example:
        >>> import torch
        >>> from skinnet.network import SkinMaps, shading_smoothness
        >>> values = torch.full((4, 1, 8, 8), 0.05)
        >>> mask = torch.ones(1, 8, 8)
        >>> maps = SkinMaps(*values, torch.zeros(1, 3, 8, 8), mask)
        >>> shading_smoothness(maps, mask).item()
        0.0
    """
    log = maps.shading.clamp_min(_DARKEST).log()
    gradient = spatial_gradient(log[:, None], mode="diff")
    return weighted_mean(gradient.abs().sum(2)[:, 0], mask)


def shading_from_luminance(maps: SkinMaps, photograph: Image, mask: Map) -> Scalar:
    """Compare log shading with the log of the photograph's smoothed luminance.

    On skin of one colour, the low frequencies of shading are those of luminance. Each photograph's
    mean difference is removed, because exposure and albedo can compensate for the level of shading.

    Args:
        maps: Predicted maps.
        photograph: Linear sRGB.
        mask: Probability of skin.

    Returns:
        Weighted mean of the absolute difference.

    Example:
        >>> import torch
        >>> from skinnet.network import SkinMaps, shading_from_luminance
        >>> values = torch.full((4, 1, 8, 8), 0.05)
        >>> mask = torch.ones(1, 8, 8)
        >>> maps = SkinMaps(*values, torch.zeros(1, 3, 8, 8), mask)
        >>> photograph = torch.full((1, 3, 8, 8), 0.3)
        >>> round(shading_from_luminance(maps, photograph, mask).item(), 4)
        0.0
    """
    size = 2 * (min(mask.shape[-2:]) // 16) + 1
    light = gaussian_blur2d(luminance(photograph), size, (size / 4, size / 4))[:, 0]
    difference = maps.shading.clamp_min(_DARKEST).log() - light.clamp_min(_DARKEST).log()
    level = (difference * mask).sum((-2, -1)) / mask.sum((-2, -1)).clamp_min(1)
    return weighted_mean((difference - level[:, None, None]).abs(), mask)


def off_skin_shading(maps: SkinMaps, mask: Map) -> Scalar:
    """Penalise shading off skin, so that the skin model explains only skin.

    Args:
        maps: Predicted maps.
        mask: Probability of skin.

    Returns:
        Mean over all pixels of shading times one minus the mask.

    Example:
        >>> import torch
        >>> from skinnet.network import SkinMaps, off_skin_shading
        >>> values = torch.full((4, 1, 8, 8), 0.05)
        >>> mask = torch.ones(1, 8, 8)
        >>> maps = SkinMaps(*values, torch.zeros(1, 3, 8, 8), mask)
        >>> round(off_skin_shading(maps, 0 * mask).item(), 4)
        0.05
    """
    return (maps.shading * (1 - mask)).mean()


def augmentation_consistency(maps: SkinMaps, mask: Map) -> Scalar:
    """Compare the pigments of photographs with those of their augmented copies, in cube roots.

    Args:
        maps: Maps of a batch whose second half shows the photographs of the first half in another
            exposure and white balance.
        mask: Probability of skin, for the whole batch.

    Returns:
        Weighted mean of |d m^(1/3)| + |d b^(1/3)| between the halves, for melanin m and blood b
        relative to their largest fractions.

    Example:
        >>> import torch
        >>> from skinnet.network import SkinMaps, augmentation_consistency
        >>> values = torch.full((4, 1, 8, 8), 0.05)
        >>> mask = torch.ones(1, 8, 8)
        >>> maps = SkinMaps(*values, torch.zeros(1, 3, 8, 8), mask)
        >>> batch = SkinMaps(*(torch.cat([value, value]) for value in maps))
        >>> augmentation_consistency(batch, torch.cat([mask, mask])).item()
        0.0
    """
    melanin, melanin_again = cube_root(maps.melanin, F_MEL_MAX).chunk(2)
    blood, blood_again = cube_root(maps.hemoglobin, F_BLOOD_MAX).chunk(2)
    difference = (melanin - melanin_again).abs() + (blood - blood_again).abs()
    return weighted_mean(difference, mask.chunk(2)[0])
