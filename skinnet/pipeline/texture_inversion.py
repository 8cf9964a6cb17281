"""Inverse rendering of a warped texture (section 4.4 of Alotaibi & Smith 2017)."""

from dataclasses import replace

import numpy as np
import torch

from skinnet.appearance.skin_texture import SkinTexture
from skinnet.pipeline.calibrate import CalibratedColours
from skinnet.texture.warp import WarpedTexture


def invert_texture(
    warped: WarpedTexture, exposure: float, colours: CalibratedColours, name: str
) -> tuple[SkinTexture, float]:
    """Invert the colours of a texture to pigments and an offset.

    Args:
        warped: Linear RGB in the model's texture space, and the mask of the known texels.
        exposure: Factor by which its colours are multiplied before the inversion.
        colours: Calibrated light and camera.
        name: Name of the texture in error messages.

    Returns:
        The maps, and the share of known texels whose colour is off the skin manifold.

    Source:
        Section 4.4 of Alotaibi & Smith 2017.
    """
    mask = warped.mask
    gain = exposure * colours.settings.balance()
    rgb = (gain * warped.image[mask]).astype(np.float32)
    inverted = colours.inverse(torch.from_numpy(rgb), colours.settings.refine)
    maps = [np.zeros((*mask.shape, *one.shape[1:]), np.float32) for one in inverted[:3]]
    for whole, part in zip(maps, inverted[:3], strict=True):
        whole[mask] = part.numpy()
    f_mel, f_blood, _ = maps
    pigments = SkinTexture(f_mel, f_blood, np.zeros((*mask.shape, 3), np.float32), mask, name)
    # The offset is relative to the table that decodes the maps, so these give the exact texture.
    offset = np.zeros((*mask.shape, 3), np.float32)
    offset[mask] = rgb - pigments.albedo(colours.colour)[mask]
    return replace(pigments, offset=offset), float(1 - inverted.on_manifold.float().mean())
