"""Errors of readings over a whole data set, in the units of the maps."""

import torch
from kornia.color import rgb_to_linear_rgb
from torch import Tensor, nn
from torchmetrics import MeanSquaredError, Metric, PearsonCorrCoef
from torchmetrics.classification import BinaryJaccardIndex

from skinnet.network import Reading
from train.batch import Batch

PIGMENTS = ("melanin", "hemoglobin")


class ReadingMetrics(nn.Module):
    """Errors over the skin of all pictures of one kind of data.

    Pixels are accumulated over batches and processes, so that each counts once. `reconstruction`
    is the RMSE in linear sRGB, clipped to [0, 1], and `mask_iou` the intersection over union of
    the masks above one half. Where there is truth, `melanin` and `hemoglobin` are RMSE in volume
    fractions, `NAME_r` is Pearson's correlation, and `NAME_constant` is the RMSE of the best
    constant prediction.
    """

    def __init__(self) -> None:
        super().__init__()
        self.metrics = nn.ModuleDict(
            {"reconstruction": MeanSquaredError(squared=False), "mask_iou": BinaryJaccardIndex()}
        )
        for name in PIGMENTS:
            self.metrics[name] = MeanSquaredError(squared=False)
            self.metrics[f"{name}_r"] = PearsonCorrCoef()
            self.metrics[f"{name}_constant"] = StandardDeviation()

    def update(self, reading: Reading, batch: Batch) -> dict[str, Metric]:
        """Add the pictures of a batch, and return the updated metrics by name."""
        skin = batch.mask > 0.5
        image = reading.reconstruction.clamp(0, 1).movedim(1, -1)
        linear = rgb_to_linear_rgb(batch.photograph).movedim(1, -1)
        pairs = {"mask_iou": (reading.maps.mask, skin)}
        # Without skin there is nothing to add, and torchmetrics refuses empty tensors.
        if skin.any():
            pairs["reconstruction"] = image[skin], linear[skin]
            if batch.truth is not None:
                for name in PIGMENTS:
                    pair = getattr(reading.maps, name)[skin], getattr(batch.truth, name)[skin]
                    pairs |= dict.fromkeys((name, f"{name}_r", f"{name}_constant"), pair)
        updated = {}
        for name, pair in pairs.items():
            metric = self.metrics[name]
            assert isinstance(metric, Metric)
            metric.update(*pair)
            updated[name] = metric
        return updated


class StandardDeviation(Metric):
    """Standard deviation of the targets: the RMSE that their mean has as a prediction."""

    moments: Tensor

    def __init__(self) -> None:
        super().__init__()
        zeros = torch.zeros(3, dtype=torch.float64)
        self.add_state("moments", zeros, dist_reduce_fx="sum")

    def update(self, _: Tensor, target: Tensor) -> None:
        """Add targets; predictions are ignored."""
        values = target.to(self.moments)
        count = torch.full_like(self.moments[0], values.numel())
        self.moments += torch.stack([count, values.sum(), (values**2).sum()])

    def compute(self) -> Tensor:
        """Compute the standard deviation of all targets."""
        count, total, squares = self.moments
        variance: Tensor = squares / count - (total / count) ** 2
        return variance.clamp_min(0).sqrt()
