"""Pigments and their spread of very many colours, from tables over the colours."""

import numpy as np
import torch
import torch.nn.functional as F
from jaxtyping import Float, Float32
from torch import Tensor

from skinnet.appearance.colour import SkinColour
from skinnet.physics._colour_posterior import ColourPosteriors
from skinnet.physics._posterior_table import PosteriorTable
from skinnet.physics.inversion import F_BLOOD_RANGE, F_MEL_RANGE, SkinInverse
from skinnet.physics.reflectance import SkinReflectance

_NOISE, _WHITE_BALANCE = 0.005, 0.02
"""Standard deviations of an albedo's channels and of its balance, as `SkinInverse.posterior`."""

_SURELY, _HARDLY = 4.0, 8.0
"""Distances in standard deviations from the nearest skin up to which a colour is skin's, and from
which it is not. Between them an edit fades, so that no border of skin shows."""

_MOST_MELANIN = 0.5
_SIDE = 33
"""Nodes of the table of nearest colours along each channel."""

_NODES = (128, 128)


class PosteriorMaps:
    """Medians and standard deviations of both fractions, and how far a colour is skin's.

    Where a colour is none of skin, the fractions are those of the nearest colour of skin, as in
    section 4.4 of Alotaibi & Smith 2017, and the standard deviations are 0.
    """

    def __init__(self, colour: SkinColour) -> None:
        key = np.ascontiguousarray(colour.matrix @ colour.calibration.T, np.float64).tobytes()
        if (key, colour.optics) not in _TABLES:
            if len(_TABLES) >= _MOST_TABLES:
                _TABLES.clear()
            _TABLES[key, colour.optics] = _tabulate(colour)
        self._table, self._nearest = _TABLES[key, colour.optics]

    @torch.no_grad()
    def __call__(
        self, linear: Float32[np.ndarray, "colours 3"]
    ) -> tuple[Float32[np.ndarray, "colours"], ...]:
        """Find f_mel, f_blood, their standard deviations, and the weight of skin."""
        finite = np.nan_to_num(linear, nan=0.0, posinf=10.0, neginf=-1.0)
        rgb = torch.from_numpy(finite).clamp(-1, 10)
        mel, mel_sd, _, blood, blood_sd, _, distance = self._table(rgb)
        skin = ((_HARDLY - distance) / (_HARDLY - _SURELY)).clamp(0, 1)
        skin = torch.where(mel <= _MOST_MELANIN, skin, 0.0)
        mel, blood = (_find_median(*pair) for pair in ((mel, mel_sd), (blood, blood_sd)))
        nearest = self._find_nearest(rgb)
        # Beyond the table's skins its values have no meaning.
        mel, blood = (
            torch.where(skin > 0, far + skin * (near - far), far)
            for near, far in zip((mel, blood), nearest, strict=True)
        )
        spreads = (torch.where(skin > 0, sd, 0.0) for sd in (mel_sd, blood_sd))
        found = (mel, blood, *spreads, skin)
        return tuple(np.asarray(plane.numpy(), np.float32) for plane in found)

    def _find_nearest(self, rgb: Float[Tensor, "colours 3"]) -> Float[Tensor, "2 colours"]:
        grid = 2 * rgb.clamp(0, 1).sqrt().flip(-1) - 1
        values = F.grid_sample(
            self._nearest, grid[None, None, None], align_corners=True, padding_mode="border"
        )
        return values[0, :, 0, 0]


_TABLES: dict[tuple[bytes, str], tuple[PosteriorTable, Tensor]] = {}
"""Tables by the matrix that makes colours; a table takes seconds, and is never changed."""

_MOST_TABLES = 4


@torch.no_grad()
def _tabulate(colour: SkinColour) -> tuple[PosteriorTable, Float[Tensor, "1 2 side side side"]]:
    """Tabulate the posterior and the nearest skins of all colours."""
    matrix = torch.from_numpy(colour.matrix @ colour.calibration.T)
    exact = SkinReflectance(colour.optics, dtype=torch.float64)
    table = ColourPosteriors(exact, matrix).tabulate(_NOISE, _WHITE_BALANCE, None)
    inverse = colour.lookup.inverse(matrix, _NODES, F_MEL_RANGE, F_BLOOD_RANGE)
    return table, _tabulate_nearest(inverse)


def _find_median(mean: Tensor, sd: Tensor) -> Tensor:
    """Median of a log-normal distribution."""
    return mean / (1 + (sd / mean).square()).sqrt()


def _tabulate_nearest(inverse: SkinInverse) -> Float[Tensor, "1 2 side side side"]:
    """Fractions of the nearest skin, over square roots of linear RGB."""
    axis = torch.linspace(0, 1, _SIDE) ** 2
    grid = torch.stack(torch.meshgrid(axis, axis, axis, indexing="ij"), -1)
    found = inverse(grid)
    return torch.stack([found.f_mel, found.f_blood])[None]
