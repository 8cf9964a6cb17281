"""How far a reading is from the truth, in the units a reader knows."""

import torch
from kornia.color import rgb_to_linear_rgb
from torch import Tensor

from skinnet.network.autoencoder import Reading
from train.batch import Batch


def measure(reading: Reading, batch: Batch) -> dict[str, Tensor]:
    """Errors over skin: `reconstruction` RMSE in linear sRGB, cut off at 1, `mask_iou`, and where
    there is truth the RMSE of `melanin` and `hemoglobin` in volume fractions, their correlation
    `_r`, and the RMSE that the best constant would have, `_constant`."""
    skin = batch.mask > 0.5
    linear = rgb_to_linear_rgb(batch.photograph)
    error = ((reading.reconstruction.clamp(0, 1) - linear) ** 2).mean(1)
    found = {
        "reconstruction": error[skin].mean().sqrt(),
        "mask_iou": _overlap(reading.maps.mask > 0.5, skin),
    }
    if batch.truth is not None:
        for name in ("melanin", "hemoglobin"):
            guess, truth = getattr(reading.maps, name)[skin], getattr(batch.truth, name)[skin]
            found[name] = ((guess - truth) ** 2).mean().sqrt()
            found[f"{name}_constant"] = truth.std(correction=0)
            found[f"{name}_r"] = torch.corrcoef(torch.stack([guess, truth]))[0, 1]
    return found


def _overlap(guess: Tensor, truth: Tensor) -> Tensor:
    return (guess & truth).sum() / (guess | truth).sum().clamp_min(1)
