"""What a network reads of the skin of a face: its mean pigments and how sure they are."""

from collections.abc import Iterable, Mapping
from typing import NamedTuple

import numpy as np
import torch
from numpy.typing import NDArray

from benchmarks.pictures import render_under_daylight
from benchmarks.portraits import average_pigments
from benchmarks.reader import NetworkReader
from benchmarks.typology import compute_typology_angle
from skinnet.network.autoencoder import SkinMaps
from skinnet.physics import Capture, SkinDecoder

Regions = Mapping[str, NDArray[np.bool_]]


class SkinReading(NamedTuple):
    """Means over the skin of faces, NaN where there is too little.

    Attributes:
        pigments: Natural logarithm of the mean fractions of melanin and hemoglobin, [..., 2].
        sd: Their standard deviations, [..., 2].
        regions: The same logarithms of each region.
    """

    pigments: NDArray[np.float64]
    sd: NDArray[np.float64]
    regions: Mapping[str, NDArray[np.float64]]


def read_skin(
    reader: NetworkReader,
    crop: NDArray[np.uint8],
    regions: Regions | None = None,
    known: Capture | None = None,
) -> SkinReading:
    """Read the skin of a face in its crop, as users do."""
    maps, _, uncertainty = reader.read(crop, known)
    skin = maps.mask > 0.5
    return SkinReading(
        average_log(maps, skin),
        uncertainty.face[0].double().numpy(),
        {
            name: average_log(maps, skin & torch.from_numpy(inside))
            for name, inside in (regions or {}).items()
        },
    )


def average_log(maps: SkinMaps, skin: torch.Tensor) -> NDArray[np.float64]:
    """Natural logarithm of the mean fractions over skin [2]; NaN if there is too little."""
    return np.log(average_pigments(maps, skin))


def stack_readings(readings: Iterable[SkinReading]) -> SkinReading:
    """Stack readings along a first axis."""
    pigments, sd, regions = zip(*readings, strict=True)
    names = regions[0]
    return SkinReading(
        np.stack(pigments),
        np.stack(sd),
        {name: np.stack([one[name] for one in regions]) for name in names},
    )


def compute_angles(pigments: NDArray[np.floating], decoder: SkinDecoder) -> NDArray[np.float64]:
    """Typology angles in degrees, under D65, of skin of mean fractions whose logarithm is given.

    Args:
        pigments: Natural logarithms of melanin and hemoglobin, [..., 2].
        decoder: Colours of the preset in which they were read.
    """
    fractions = torch.from_numpy(np.nan_to_num(np.exp(pigments))).float().reshape(-1, 2)
    colour = render_under_daylight(*fractions.unbind(1), decoder)
    angles = compute_typology_angle(colour).double().numpy().reshape(pigments.shape[:-1])
    return np.where(np.isfinite(pigments).all(-1), angles, np.nan)
