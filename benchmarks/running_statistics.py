"""Sums from which errors and correlations follow, so that no pixel has to be kept."""

import torch
from torch import Tensor

NEGLIGIBLE = 1e-12
"""Variance relative to the mean square below which a value counts as constant."""


class RunningStatistics:
    """Of a guess and the truth: number, sums, squares, products and errors, in float64.

    Every figure is None where nothing was added, or where it is not defined.
    """

    def __init__(self) -> None:
        self.sums = torch.zeros(7, dtype=torch.float64)

    def add(self, guess: Tensor, truth: Tensor) -> None:
        """Count in two tensors of one shape."""
        x, y = (value.reshape(-1).to(torch.float64) for value in (guess, truth))
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
        """Pearson's correlation; a constant has none."""
        count, x, y, xx, yy, xy = (self.sums[:6] / self.sums[0].clamp_min(1)).tolist()
        spread = xx - x * x, yy - y * y
        if not count or spread[0] <= NEGLIGIBLE * xx or spread[1] <= NEGLIGIBLE * yy:
            return None
        return float((xy - x * y) / (spread[0] * spread[1]) ** 0.5)

    @property
    def line(self) -> tuple[float, float]:
        """Slope and offset that bring the guess nearest to the truth."""
        _, x, y, xx, _, xy = (self.sums[:6] / self.sums[0]).tolist()
        slope = (xy - x * y) / (xx - x * x)
        return slope, y - slope * x

    @property
    def scale(self) -> float:
        """The factor that brings the guess nearest to the truth."""
        return (self.sums[5] / self.sums[3]).item()
