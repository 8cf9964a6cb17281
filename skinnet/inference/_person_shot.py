"""What is kept of a decomposed photograph when shots of one person are fused."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from skinnet.errors import InputError
from skinnet.images.faces._face_regions import REGION_NAMES
from skinnet.inference._uncertainty import PIGMENTS
from skinnet.inference.decomposition import Decomposition

Array = NDArray[np.float64]


class PersonShot(NamedTuple):
    """One shot of a person: a few numbers, since the maps of many shots need much memory.

    Attributes:
        name: What messages call it.
        log_means: Natural logarithms of the mean melanin and hemoglobin, of the whole skin in the
            first row and then of each region, [1 + regions, 2]; NaN where it is hidden.
        log_sds: Their standard deviations, [1 + regions, 2].
        chromaticity: Log R/G and log B/G of the skin's mean colour in linear sRGB, [2]; NaN if it
            is not known.
        tops: Largest fractions of melanin and hemoglobin.
        has_face: Whether a face was looked for, so that there are regions.
        model: The model that has read it.
        capture_known: Names of what was given of its capture.
        notes: Sentences on it that the user should read.
    """

    name: str
    log_means: Array
    log_sds: Array
    chromaticity: Array
    tops: tuple[float, float]
    has_face: bool
    model: dict[str, str]
    capture_known: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()

    @property
    def has_skin(self) -> bool:
        """Whether any skin was found."""
        return bool(np.isfinite(self.log_means[0]).all())


def describe_shot(decomposition: Decomposition, name: str) -> PersonShot:
    """Keep of a decomposition what is fused."""
    if not isinstance(decomposition, Decomposition):
        raise InputError(
            f"A shot is a Decomposition, which a Decomposer makes; got {decomposition!r:.60}."
        )
    face = [(decomposition.means.get(each), None) for each in PIGMENTS]
    regions = decomposition.regions
    places = [face] + [
        [(getattr(regions[each], name).mean, getattr(regions[each], name).sd) for name in PIGMENTS]
        if each in regions
        else [(None, None)] * 2
        for each in REGION_NAMES
    ]
    means, sds = np.moveaxis(np.array(places, float), -1, 0)
    with np.errstate(divide="ignore"):  # of a mean of 0 the logarithm is not finite: not read
        log_means = np.log(means)
    log_sds = sds / means
    log_sds[0] = decomposition.uncertainty.face
    melanin, hemoglobin = (decomposition.output_info[each].range[1] for each in PIGMENTS)
    return PersonShot(
        name,
        np.where(np.isfinite(log_means), log_means, np.nan),
        log_sds,
        np.array(decomposition.skin_chromaticity or (np.nan, np.nan)),
        (melanin, hemoglobin),
        bool(regions),
        decomposition.model,
        decomposition.capture_known,
        decomposition.notes,
    )
