"""Errors and correlations from running sums, so that no pixel has to be kept."""

import torch
from torch import Tensor

NEGLIGIBLE = 1e-12
"""Variance relative to the mean square below which a value counts as constant."""


class RunningStatistics:
    """Statistics of an estimate and the truth, from sums in float64.

    A figure is None if nothing was added, or if it is not defined.
    """

    def __init__(self) -> None:
        self.sums = torch.zeros(7, dtype=torch.float64)

    def add(self, estimate: Tensor, truth: Tensor) -> None:
        """Add two tensors of the same shape."""
        x, y = (value.reshape(-1).to(torch.float64) for value in (estimate, truth))
        error = x - y
        sums = [x.sum(), y.sum(), x @ x, y @ y, x @ y, error @ error]
        self.sums += torch.stack([torch.tensor(float(len(x)), dtype=torch.float64), *sums])

    @property
    def rmse(self) -> float | None:
        """Root of the mean squared error."""
        count, error = self.sums[0].item(), self.sums[6].item()
        return (error / count) ** 0.5 if count else None

    @property
    def truth(self) -> float | None:
        """Mean of the truth."""
        return (self.sums[2] / self.sums[0]).item() if self.sums[0] else None

    @property
    def r(self) -> float | None:
        """Pearson's correlation, None for a constant."""
        count, x, y, xx, yy, xy = (self.sums[:6] / self.sums[0].clamp_min(1)).tolist()
        spread = xx - x * x, yy - y * y
        if not count or spread[0] <= NEGLIGIBLE * xx or spread[1] <= NEGLIGIBLE * yy:
            return None
        return float((xy - x * y) / (spread[0] * spread[1]) ** 0.5)

    @property
    def line(self) -> tuple[float, float]:
        """Slope and offset of the least-squares line from the estimate to the truth."""
        _, x, y, xx, _, xy = (self.sums[:6] / self.sums[0]).tolist()
        slope = (xy - x * y) / (xx - x * x)
        return slope, y - slope * x

    @property
    def scale(self) -> float:
        """Least-squares factor from the estimate to the truth."""
        return (self.sums[5] / self.sums[3]).item()
