"""Two degradations of one photograph, whose skin is the same: small, compressed, graded."""

from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from benchmarks.disturbances import compress
from benchmarks.face_photographs import FacePhotograph, find_face
from skinnet.images import linear_to_srgb, read_photo, resize, srgb_to_linear, to_uint8

GAIN_SD, EXPOSURE_SD, CONTRAST_SD, SATURATION_SD = (0.15, 0.17), 0.3, 0.12, 0.12
"""Standard deviations of the logarithms of what changes: gains of red and blue, which are those of
portraits by different photographers, exposure, contrast and saturation."""

_PIVOT = 0.18

Photograph = NDArray[np.uint8]


class Degradation(NamedTuple):
    """Width in pixels and quality of the JPEG."""

    width: int
    quality: int


DEGRADATIONS = Degradation(96, 25), Degradation(200, 60)


def degrade(photo: Photograph, kind: Degradation, rng: np.random.Generator) -> Photograph:
    """Change white balance, exposure and tones at random, then shrink and compress."""
    width = min(kind.width, photo.shape[1])
    height = max(1, round(photo.shape[0] * width / photo.shape[1]))
    return compress(change_tones(resize(photo, width, height), rng), kind.quality)


def change_tones(photo: Photograph, rng: np.random.Generator) -> Photograph:
    """Change white balance, exposure, contrast and saturation at random."""
    red, blue = rng.normal(0, GAIN_SD)
    exposure, contrast, saturation = rng.normal(0, (EXPOSURE_SD, CONTRAST_SD, SATURATION_SD))
    linear = srgb_to_linear(photo) * np.exp(exposure + np.array([red, 0, blue]))
    graded = _PIVOT * (linear / _PIVOT) ** np.exp(contrast)
    grey = graded.mean(-1, keepdims=True)
    graded = grey + np.exp(saturation) * (graded - grey)
    return to_uint8(linear_to_srgb(graded.clip(0, 1).astype(np.float32)))


def read_degraded(
    paths: Iterable[Path], seed: int = 0
) -> Iterator[tuple[FacePhotograph, FacePhotograph]]:
    """Yield both degradations of photographs; those without a face in one are left out."""
    for number, path in enumerate(paths):
        photo = read_photo(path)
        rngs = np.random.default_rng([seed, number]).spawn(len(DEGRADATIONS))
        first, second = (
            find_face(degrade(photo, kind, rng))
            for kind, rng in zip(DEGRADATIONS, rngs, strict=True)
        )
        if first is not None and second is not None:
            yield first, second


def list_second_source(folder: Path, people: Iterable[str]) -> dict[str, list[Path]]:
    """List the photographs of London, and those of Congress that do not show these people."""
    known = set(people)
    congress = sorted((folder / "congress").glob("*.jpg"))
    return {
        "london": sorted((folder / "london").glob("*.jpg")),
        "congress": [path for path in congress if path.stem not in known],
    }
