"""Losses of the autoencoder, each a mean over the photographs of a batch.

A photograph's own loss does not depend on the others: processes that share a batch evenly have the
mean of their losses in common, and it is that of the whole batch.

Images are linear sRGB [batch, 3, height, width], maps [batch, height, width], and a mask holds the
probability that a pixel is skin.
"""

from jaxtyping import Float
from kornia.color import rgb_to_grayscale
from kornia.filters import gaussian_blur2d, spatial_gradient
from torch import Tensor

from skinnet.network.autoencoder import F_BLOOD_MAX, F_MEL_MAX, SkinMaps
from skinnet.physics.capture import Capture

Image = Float[Tensor, "batch 3 height width"]
Map = Float[Tensor, "batch height width"]
Scalar = Float[Tensor, ""]

WHITE_BALANCE_SD = 0.05
"""Spread allowed to the errors of a camera's white balance in log R/G and log B/G."""

SPREAD = 0.066, 0.024
"""Standard deviations of melanin and hemoglobin over the twin's skin."""

LIT = 0.85
"""Mean shading of the twin's skin."""

_DARKEST = 1e-3
_FAINT = 1e-4


def appearance(reconstruction: Image, photograph: Image, weight: Map) -> Scalar:
    """Mean absolute difference in linear sRGB, each pixel weighted.

    A photograph ends at 1, and where it does, whatever is brighter explains it.
    """
    burnt = (photograph >= 1) & (reconstruction > photograph)
    difference = (reconstruction - photograph).abs().masked_fill(burnt, 0)
    return _mean(difference.mean(1), weight)


def camera_prior(capture: Capture) -> Scalar:
    """Negative log likelihood of the camera and its white balance under their normal spread."""
    balance = (capture.white_balance / WHITE_BALANCE_SD) ** 2
    return (capture.camera**2).mean() / 2 + balance.mean() / 2


def specular_sparsity(maps: SkinMaps, mask: Map) -> Scalar:
    """Mean specular on skin (an L1 prior: highlights are rare, not absent)."""
    return _mean(maps.specular, mask)


def shading_smoothness(maps: SkinMaps, mask: Map) -> Scalar:
    """Mean absolute gradient of log shading on skin, per pixel."""
    log = maps.shading.clamp_min(_DARKEST).log()
    gradient = spatial_gradient(log[:, None], mode="diff")
    return _mean(gradient.abs().sum(2)[:, 0], mask)


def shading_pseudo(maps: SkinMaps, photograph: Image, mask: Map) -> Scalar:
    """Log shading against the log of the photograph's smoothed luminance, each less its mean.

    Where there is no true shading its low frequencies are those of luminance on skin of one colour;
    its level is left open, since exposure and albedo trade against it.
    """
    size = 2 * (min(mask.shape[-2:]) // 16) + 1
    light = gaussian_blur2d(rgb_to_grayscale(photograph), size, (size / 4, size / 4))[:, 0]
    difference = maps.shading.clamp_min(_DARKEST).log() - light.clamp_min(_DARKEST).log()
    level = (difference * mask).sum((-2, -1)) / mask.sum((-2, -1)).clamp_min(1)
    return _mean((difference - level[:, None, None]).abs(), mask)


def stray(maps: SkinMaps, mask: Map) -> Scalar:
    """Mean shading of what is not skin: skin explains skin alone."""
    return (maps.shading * (1 - mask)).mean()


def skin_mask(maps: SkinMaps, mask: Map) -> Scalar:
    """Cross entropy of the skin mask."""
    # torch's own refuses what is not a number, on a GPU by ending the process.
    skin = maps.mask.clamp(1e-6, 1 - 1e-6)
    return -(mask * skin.log() + (1 - mask) * (1 - skin).log()).mean()


def overlap(maps: SkinMaps, mask: Map) -> Scalar:
    """What the skin mask lacks of an intersection over union of one; skin is a mask above one half.

    A cross entropy alone lets thin beards and loose hair stay near one half on either side.
    """
    skin, over = (mask > 0.5).to(mask), (-2, -1)
    common = (maps.mask * skin).sum(over)
    whole = (maps.mask + skin).sum(over) - common
    # One pixel more in both, so that no skin found where there is none is right.
    return (1 - (common + 1) / (whole + 1)).mean()


def pigments(maps: SkinMaps, truth: SkinMaps) -> Scalar:
    """Mean absolute error of both pigments on true skin, in cube roots of their range.

    Even steps there are about even steps of colour; in fractions, dark skin alone would count.
    """
    melanin = _root(maps.melanin, F_MEL_MAX) - _root(truth.melanin, F_MEL_MAX)
    blood = _root(maps.hemoglobin, F_BLOOD_MAX) - _root(truth.hemoglobin, F_BLOOD_MAX)
    return _mean(melanin.abs() + blood.abs(), truth.mask)


def fractions(maps: SkinMaps, truth: SkinMaps) -> Scalar:
    """Mean squared error of both pigments on true skin, in standard deviations of each.

    `pigments` is of typical errors and of all skin alike; this one is of the largest, which are
    those of dark skin and of much blood.
    """
    melanin, blood = (
        ((guess - true) / spread) ** 2
        for guess, true, spread in zip(maps[:2], truth[:2], SPREAD, strict=True)
    )
    return _mean(melanin + blood, truth.mask)


def leak(maps: SkinMaps, truth: SkinMaps) -> Scalar:
    """Minus the mean product of melanin's error, in cube roots, and of the true shading beyond
    `LIT`, cut off at 2.

    Pale skin in little light looks as dark skin in much of it does, and whoever guesses best
    between them says too little melanin where the light is strong. Its weight is the Lagrange
    multiplier of asking that errors do not follow the light; more than needed turns the sign, and
    with seven eighths of the weight of `pigments` or more it has no minimum.
    """
    error = _root(maps.melanin, F_MEL_MAX) - _root(truth.melanin, F_MEL_MAX)
    return -_mean(error * (truth.shading.clamp_max(2) - LIT), truth.mask)


def steadiness(maps: SkinMaps, mask: Map) -> Scalar:
    """Mean absolute difference of both pigments between the halves of a batch, in cube roots.

    The second half shows the photographs of the first in another exposure and white balance, and a
    face keeps its pigments.
    """
    melanin, again = _root(maps.melanin, F_MEL_MAX).chunk(2)
    blood, blood_again = _root(maps.hemoglobin, F_BLOOD_MAX).chunk(2)
    return _mean((melanin - again).abs() + (blood - blood_again).abs(), mask.chunk(2)[0])


def lighting(maps: SkinMaps, truth: SkinMaps) -> Scalar:
    """Mean absolute error of shading, and ten times the squared one of root specular.

    Most skin has next to no gloss, so that an absolute error is least where none is ever seen.
    """
    gloss = (maps.specular + _FAINT).sqrt() - (truth.specular + _FAINT).sqrt()
    return (10 * gloss**2 + (maps.shading - truth.shading).abs()).mean()


def white_balance(capture: Capture, truth: Capture) -> Scalar:
    """Mean absolute error of the white balance in units of its spread."""
    return (capture.white_balance - truth.white_balance).abs().mean() / WHITE_BALANCE_SD


def _root(fraction: Map, largest: float) -> Map:
    # Zero has no slope under a cube root.
    return (fraction / largest).clamp_min(1e-6) ** (1 / 3)


def _mean(value: Map, weight: Map) -> Scalar:
    over = (-2, -1)
    return ((value * weight).sum(over) / weight.sum(over).clamp_min(1)).mean()
