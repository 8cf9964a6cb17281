from .agreement import agreement_likelihood as agreement_likelihood
from .agreement import colour_prediction as colour_prediction
from .agreement import measure_skin_colour as measure_skin_colour
from .agreement import region_agreement as region_agreement
from .autoencoder import CAMERA_MAX as CAMERA_MAX
from .autoencoder import F_BLOOD_MAX as F_BLOOD_MAX
from .autoencoder import F_MEL_MAX as F_MEL_MAX
from .autoencoder import SHADING_MAX as SHADING_MAX
from .autoencoder import WHITE_BALANCE_MAX as WHITE_BALANCE_MAX
from .autoencoder import AutoencoderConfig as AutoencoderConfig
from .autoencoder import Reading as Reading
from .autoencoder import SkinAutoencoder as SkinAutoencoder
from .autoencoder import SkinMaps as SkinMaps
from .autoencoder import Uncertainty as Uncertainty
from .checkpoint import read_checkpoint as read_checkpoint
from .encoder import SkinEncoder as SkinEncoder
from .losses import appearance_l1 as appearance_l1
from .losses import error_shading_covariance as error_shading_covariance
from .losses import lighting_error as lighting_error
from .losses import mask_cross_entropy as mask_cross_entropy
from .losses import pigment_l1 as pigment_l1
from .losses import pigment_likelihood as pigment_likelihood
from .losses import pigment_mse as pigment_mse
from .losses import soft_iou as soft_iou
from .losses import white_balance_l1 as white_balance_l1
from .priors import augmentation_consistency as augmentation_consistency
from .priors import camera_prior as camera_prior
from .priors import off_skin_shading as off_skin_shading
from .priors import shading_from_luminance as shading_from_luminance
from .priors import shading_smoothness as shading_smoothness
from .priors import specular_sparsity as specular_sparsity

__all__ = [
    "CAMERA_MAX",
    "F_BLOOD_MAX",
    "F_MEL_MAX",
    "SHADING_MAX",
    "WHITE_BALANCE_MAX",
    "AutoencoderConfig",
    "Reading",
    "SkinAutoencoder",
    "SkinEncoder",
    "SkinMaps",
    "Uncertainty",
    "agreement_likelihood",
    "appearance_l1",
    "augmentation_consistency",
    "camera_prior",
    "colour_prediction",
    "error_shading_covariance",
    "lighting_error",
    "mask_cross_entropy",
    "measure_skin_colour",
    "off_skin_shading",
    "pigment_l1",
    "pigment_likelihood",
    "pigment_mse",
    "read_checkpoint",
    "region_agreement",
    "shading_from_luminance",
    "shading_smoothness",
    "soft_iou",
    "specular_sparsity",
    "white_balance_l1",
]
