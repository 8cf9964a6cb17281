"""Errors and correlations of a row, the columns of the table."""

from typing import Any

import torch
from torch import Tensor

from benchmarks.coverage import Coverage
from benchmarks.pictures import Pictures, Pixels, average_by_picture
from benchmarks.running_statistics import RunningStatistics
from benchmarks.typology import GROUPS, find_group
from skinnet.network.autoencoder import F_MEL_MAX

PIGMENTS = {"melanin": F_MEL_MAX, "hemoglobin": 0.07}
"""The fractions that are 1 on BioFaceNet's look-up grid."""

COLUMNS = {
    "diffuse": "shading",
    "specular": "specular",
    "albedo": "albedo",
    "reconstruction": "colour",
}
"""Columns that hold an RMSE over skin, and the field of `Pixels` that each measures."""


class Scores:
    """Statistics of the pictures that were added, and the columns computed from them."""

    def __init__(self) -> None:
        self.pixel, self.image, self.grid = (
            {name: RunningStatistics() for name in PIGMENTS} for _ in range(3)
        )
        self.columns = {name: RunningStatistics() for name in COLUMNS}
        self.groups = {name: RunningStatistics() for name in GROUPS}
        self.pictures = dict.fromkeys(GROUPS, 0)
        self.error_and_shading, self.explained = RunningStatistics(), RunningStatistics()
        self.coverage = Coverage()
        self.iou_sums: Tensor | None = torch.zeros(2, dtype=torch.float64)

    def add(self, guess: Pixels, pictures: Pictures) -> None:
        """Add the pixels of some pictures."""
        truth = pictures.truth
        for name, most in PIGMENTS.items():
            both = getattr(guess, name), getattr(truth, name)
            self.pixel[name].add(*both)
            self.grid[name].add(*(2 * (one.double() / most) ** (1 / 3) - 1 for one in both))
            by_picture = [
                average_by_picture(one, pictures.picture, len(pictures.angle)) for one in both
            ]
            with_skin = by_picture[1].isfinite()
            self.image[name].add(*(one[with_skin] for one in by_picture))
        for name, field in COLUMNS.items():
            if getattr(guess, field) is not None:
                self.columns[name].add(getattr(guess, field), getattr(truth, field))
        if guess.explained is not None and truth.colour is not None:
            self.explained.add(guess.explained, truth.colour)
        assert truth.shading is not None
        self.error_and_shading.add(guess.melanin - truth.melanin, truth.shading)
        self.coverage.add(guess, pictures)
        self._add_groups(guess, pictures)
        self._add_mask(guess.mask, pictures.skin)

    def _add_groups(self, guess: Pixels, pictures: Pictures) -> None:
        for number, angle in enumerate(pictures.angle.tolist()):
            here = pictures.picture == number
            if here.any():
                self.pictures[find_group(angle)] += 1
                self.groups[find_group(angle)].add(
                    guess.melanin[here], pictures.truth.melanin[here]
                )

    def _add_mask(self, guess: Tensor | None, skin: Tensor) -> None:
        if guess is None or self.iou_sums is None:
            self.iou_sums = None
        else:
            self.iou_sums += torch.stack([(guess & skin).sum(), (guess | skin).sum()]).double()

    def compute_results(self, constant: "Scores") -> dict[str, Any]:
        """Compute every column; `constant` has the scores of the constant predictor."""
        relative = [one["relative_rmse"] for one in self.group_by_tone().values()]
        return {
            **{name: self._compute_pigment(name, constant) for name in PIGMENTS},
            **{name: moments.rmse for name, moments in self.columns.items()},
            "mask_iou": None if self.iou_sums is None else _divide(*self.iou_sums.tolist()),
            "leak": self.error_and_shading.r,
            "group_ratio": _divide(max(relative), min(relative)) if relative else None,
        }

    def _compute_pigment(self, name: str, constant: "Scores") -> dict[str, float | None]:
        rmse, other = self.pixel[name].rmse, constant.pixel[name].rmse
        return {
            "rmse": rmse,
            "rmse_ratio": None if rmse is None or other is None else _divide(rmse, other),
            "r_pixel": self.pixel[name].r,
            "r_image": self.image[name].r,
            "grid_rmse": self.grid[name].rmse,
        }

    def group_by_tone(self) -> dict[str, dict[str, Any]]:
        """Compute melanin by skin tone: pictures, true mean, RMSE, and RMSE over that mean."""
        found = {}
        for name, moments in self.groups.items():
            if moments.rmse is not None and moments.truth:
                found[name] = {
                    "pictures": self.pictures[name],
                    "mean": moments.truth,
                    "rmse": moments.rmse,
                    "relative_rmse": moments.rmse / moments.truth,
                }
        return found


def _divide(over: float, under: float) -> float | None:
    return over / under if under else None
