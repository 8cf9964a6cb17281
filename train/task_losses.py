"""The losses of a training step and their weights."""

from dataclasses import dataclass

from jsonargparse.typing import NonNegativeFloat
from kornia.color import rgb_to_linear_rgb
from torch import Tensor

from skinnet.network import Reading, SkinMaps, losses, priors
from skinnet.physics import Capture
from train.batch import Batch


@dataclass
class LossWeights:
    """Weight of each loss.

    The first three losses apply to every picture. Those from `mask` to `uncertainty` need truth.
    The others apply to pictures without truth.

    Attributes:
        appearance: Reconstruction of skin, L1.
        background_reconstruction: Reconstruction of what is not skin, L1.
        off_skin_shading: Shading where there is no skin.
        mask: Cross entropy of the skin mask.
        soft_iou: Soft intersection over union of the skin mask.
        pigment_l1: Pigments, L1 in cube roots.
        pigment_mse: Pigments, standardised squared error.
        error_shading_covariance: Covariance of melanin's error with shading.
        lighting: Shading and specular reflection.
        white_balance: White balance, L1.
        uncertainty: Negative log likelihood of the pigments' errors.
        augmentation_consistency: Pigments under changes of exposure and white balance.
        mask_guess: Cross entropy with an estimated mask.
        camera: Prior of camera and white balance.
        specular: Sparsity of specular reflection.
        smoothness: Smoothness of shading.
        shading: Shading against the luminance of the photograph.
        agreement: Pigments of the same regions in two photographs of a person.
        prediction: Colour of a person in another photograph.
        agreement_uncertainty: Negative log likelihood of the difference of two photographs.
    """

    appearance: NonNegativeFloat = 4.0
    background_reconstruction: NonNegativeFloat = 0.2
    off_skin_shading: NonNegativeFloat = 2.0
    mask: NonNegativeFloat = 2.0
    soft_iou: NonNegativeFloat = 1.0
    pigment_l1: NonNegativeFloat = 8.0
    pigment_mse: NonNegativeFloat = 1.0
    error_shading_covariance: NonNegativeFloat = 3.0
    lighting: NonNegativeFloat = 1.0
    white_balance: NonNegativeFloat = 2.0
    uncertainty: NonNegativeFloat = 0.3
    augmentation_consistency: NonNegativeFloat = 3.0
    mask_guess: NonNegativeFloat = 0.05
    camera: NonNegativeFloat = 0.005
    specular: NonNegativeFloat = 0.01
    smoothness: NonNegativeFloat = 0.02
    shading: NonNegativeFloat = 0.02
    agreement: NonNegativeFloat = 1.0
    prediction: NonNegativeFloat = 1.0
    agreement_uncertainty: NonNegativeFloat = 0.1


def compute_losses(reading: Reading, batch: Batch) -> dict[str, Tensor]:
    """Compute every loss that applies to a batch, by its name in `LossWeights`."""
    linear, mask = rgb_to_linear_rgb(batch.photograph), batch.mask
    parts = {
        "appearance": losses.appearance_l1(reading.reconstruction, linear, mask),
        "background_reconstruction": losses.appearance_l1(reading.reconstruction, linear, 1 - mask),
        "off_skin_shading": priors.off_skin_shading(reading.maps, mask),
    }
    if batch.truth is not None and batch.capture is not None:
        return parts | _compare_with_truth(reading, batch.truth, batch.capture)
    return parts | _compute_priors(reading, batch, linear)


def _compare_with_truth(reading: Reading, truth: SkinMaps, capture: Capture) -> dict[str, Tensor]:
    maps = reading.maps
    return {
        "mask": losses.mask_cross_entropy(maps, truth.mask),
        "soft_iou": losses.soft_iou(maps, truth.mask),
        "pigment_l1": losses.pigment_l1(maps, truth),
        "pigment_mse": losses.pigment_mse(maps, truth),
        "error_shading_covariance": losses.error_shading_covariance(maps, truth),
        "lighting": losses.lighting_error(maps, truth),
        "white_balance": losses.white_balance_l1(reading.capture, capture),
        "uncertainty": losses.pigment_likelihood(maps, reading.uncertainty, truth),
    }


def _compute_priors(reading: Reading, batch: Batch, linear: Tensor) -> dict[str, Tensor]:
    """Losses of photographs without truth; `linear` is the photograph in linear sRGB."""
    maps, mask = reading.maps, batch.mask
    parts = {}
    if batch.paired:
        parts["augmentation_consistency"] = priors.augmentation_consistency(maps, mask)
    return parts | {
        "mask_guess": losses.mask_cross_entropy(maps, mask),
        "camera": priors.camera_prior(reading.capture),
        "specular": priors.specular_sparsity(maps, mask),
        "smoothness": priors.shading_smoothness(maps, mask),
        "shading": priors.shading_from_luminance(maps, linear, mask),
    }
