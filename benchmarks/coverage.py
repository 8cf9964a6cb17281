"""How often the truth lies inside the intervals that a network states."""

from typing import Any

import torch
from scipy.stats import norm
from torch import Tensor

from benchmarks.pictures import Pictures, Pixels, average_by_picture
from benchmarks.portraits import PIGMENTS
from benchmarks.typology import GROUPS, find_group

LEVEL = 0.9
"""Probability of the intervals."""


class Coverage:
    """Counts of values whose logarithm lies inside its interval, by pigment and tone group."""

    def __init__(self, level: float = LEVEL) -> None:
        self.z = float(norm.ppf((1 + level) / 2))
        self.stated: dict[str, list[Tensor]] = {name: [] for name in PIGMENTS}
        self.faces, self.pixels = (
            {name: {group: [0, 0] for group in GROUPS} for name in PIGMENTS} for _ in range(2)
        )

    def add(self, guess: Pixels, pictures: Pictures) -> None:
        """Add the pixels and the means of some pictures, if the guess says how sure it is."""
        if guess.sd is None or guess.face_sd is None:
            return
        groups = [find_group(angle) for angle in pictures.angle.tolist()]
        number = torch.tensor([list(GROUPS).index(group) for group in groups])
        for index, name in enumerate(PIGMENTS):
            self.stated[name].append(guess.face_sd[:, index])
            read, true = getattr(guess, name), getattr(pictures.truth, name)
            inside = self._compare(read, true, guess.sd[:, index])
            _count(self.pixels[name], inside, number[pictures.picture])
            means = [average_by_picture(one, pictures.picture, len(groups)) for one in (read, true)]
            seen = means[1].isfinite()
            inside = self._compare(*(one[seen] for one in (*means, guess.face_sd[:, index])))
            _count(self.faces[name], inside, number[seen])

    def _compare(self, read: Tensor, true: Tensor, sd: Tensor) -> Tensor:
        return (read.log() - true.log()).abs() <= self.z * sd

    def compute_results(self) -> dict[str, Any]:
        """Compute the share that is inside, of faces (`coverage`) and of pixels.

        `stated_sd` is the median of what is stated of faces.
        """
        return {
            "stated_sd": {
                name: float(torch.cat(one).median()) if one else None
                for name, one in self.stated.items()
            },
            "coverage": {name: _divide(one) for name, one in self.faces.items()},
            "coverage_pixels": {name: _divide(one) for name, one in self.pixels.items()},
        }


def _count(counts: dict[str, list[int]], inside: Tensor, number: Tensor) -> None:
    for place, group in enumerate(counts):
        mine = number == place
        counts[group][0] += int((inside & mine).sum())
        counts[group][1] += int(mine.sum())


def _divide(counts: dict[str, list[int]]) -> dict[str, Any]:
    inside, all_ = (sum(values) for values in zip(*counts.values(), strict=True))
    return {
        "all": inside / all_ if all_ else None,
        "groups": {name: a / b for name, (a, b) in counts.items() if b},
    }
