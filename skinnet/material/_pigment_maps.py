"""Pigments of very many colours, their spread, and whether they are skin's."""

import numpy as np
import torch
from jaxtyping import Float32

from skinnet.appearance.colour import SkinColour
from skinnet.material._nearest_skin import NearestSkin
from skinnet.physics._colour_posterior import ColourPosteriors
from skinnet.physics._posterior_table import PosteriorTable
from skinnet.physics.reflectance import SkinReflectance

_NOISE, _WHITE_BALANCE = 0.005, 0.02
"""Standard deviations of an albedo's channels and of its balance, as `SkinInverse.posterior`."""

_SURELY, _HARDLY = 4.0, 8.0
"""Distances in standard deviations from the nearest skin up to which a colour is skin's, and from
which it is not. Between them an edit fades, so that no border of skin shows."""

_SOON = 4.0
"""Even a colour that is a quarter skin's gets the exact fractions."""

_ROWS = (0, 1, 4, 6)
"""Rows of the posterior: the mean of f_mel, both standard deviations, and the distance."""

_MOST_MELANIN = 0.5


class PigmentMaps:
    """Fractions of the nearest skin, their spread in the posterior, and how far a colour is skin's.

    The fractions are those of section 4.4 of Alotaibi & Smith 2017, so a colour of the model gives
    its own. The standard deviations are those of the posterior over the skins of people that have
    the colour; where it is none of skin, they are 0.
    """

    def __init__(self, colour: SkinColour) -> None:
        key = np.ascontiguousarray(colour.matrix @ colour.calibration.T, np.float64).tobytes()
        if (key, colour.optics) not in _TABLES:
            if len(_TABLES) >= _MOST_TABLES:
                _TABLES.clear()
            _TABLES[key, colour.optics] = _tabulate(colour)
        self._posterior, self._nearest = _TABLES[key, colour.optics]

    @torch.no_grad()
    def __call__(
        self, linear: Float32[np.ndarray, "colours 3"]
    ) -> tuple[Float32[np.ndarray, "colours"], ...]:
        """Find f_mel, f_blood, their standard deviations, and the weight of skin."""
        finite = np.nan_to_num(linear, nan=0.0, posinf=10.0, neginf=-1.0)
        rgb = torch.from_numpy(finite).clamp(-1, 10)
        mean, mel_sd, blood_sd, distance = self._posterior(rgb)
        skin = ((_HARDLY - distance) / (_HARDLY - _SURELY)).clamp(0, 1)
        known = torch.from_numpy(np.isfinite(linear).all(-1))
        skin = torch.where(known & (mean <= _MOST_MELANIN), skin, 0.0)
        mel, blood = self._nearest(rgb, (_SOON * skin).clamp(0, 1))
        # Beyond the table's skins its values have no meaning.
        spreads = (torch.where(skin > 0, sd, 0.0) for sd in (mel_sd, blood_sd))
        found = (mel, blood, *spreads, skin)
        return tuple(np.asarray(plane.numpy(), np.float32) for plane in found)


_TABLES: dict[tuple[bytes, str], tuple[PosteriorTable, NearestSkin]] = {}
"""Tables by the matrix that makes colours; a table takes seconds, and is never changed."""

_MOST_TABLES = 4


@torch.no_grad()
def _tabulate(colour: SkinColour) -> tuple[PosteriorTable, NearestSkin]:
    """Tabulate the posterior and the nearest skins of all colours."""
    matrix = torch.from_numpy(colour.matrix @ colour.calibration.T)
    exact = SkinReflectance(colour.optics, dtype=torch.float64)
    table = ColourPosteriors(exact, matrix).tabulate(_NOISE, _WHITE_BALANCE, None)
    return table.select(_ROWS), NearestSkin(colour.lookup, matrix)
