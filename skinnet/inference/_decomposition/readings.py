"""The numbers that follow from the maps: means, intervals, indices and regions."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from skinnet.images.faces._face_parts import FaceRegion
from skinnet.inference._decomposition.face_maps import FaceMaps
from skinnet.inference._decomposition.maps import SKIN_THRESHOLD
from skinnet.inference._index_summary import SkinIndices
from skinnet.inference._regions import Pigment, RegionSummary, summarise_region
from skinnet.inference._uncertainty import (
    LEVEL,
    PIGMENTS,
    describe_mean,
    find_factor,
    find_interval,
)
from skinnet.inference.indices import _find_indices


class _Regions(dict[str, RegionSummary]):
    def __missing__(self, name: str) -> RegionSummary:
        raise KeyError(f"The regions are {', '.join(self) or 'none'}; got {name!r:.60}.")


@dataclass(frozen=True, eq=False, repr=False)
class SkinReadings(FaceMaps):
    """Maps with their means, and how certain these are."""

    def __repr__(self) -> str:
        height, width = self.mask.shape
        if not self.means:
            return f"<Decomposition {width} x {height}: no skin>"
        intervals = self.interval()
        pigments = (
            f"{name} {describe_mean(mean, intervals[name])}" for name, mean in self.means.items()
        )
        return (
            f"<Decomposition {width} x {height}: {', '.join(pigments)}, "
            f"{self.skin_share:.0%} is skin>"
        )

    @property
    def skin_share(self) -> float:
        """Share of skin in what was read: in `box`, or in the turned square that it bounds."""
        area = self.box.width * self.box.height if self.pixels_read is None else self.pixels_read
        return np.count_nonzero(self.mask > SKIN_THRESHOLD) / max(area, 1)

    @cached_property
    def means(self) -> dict[str, float]:
        """Mean `melanin` and `hemoglobin` of the skin; empty if there is none."""
        skin = self.mask > SKIN_THRESHOLD
        if not skin.any():
            return {}
        return {name: float(np.mean(getattr(self, name)[skin], dtype=float)) for name in PIGMENTS}

    def interval(self, level: float = LEVEL) -> dict[str, tuple[float, float]]:
        """Find between which fractions the mean pigments of the skin truly lie.

        Pixels and regions are less certain than the mean: `melanin_sd`, `regions`.

        Args:
            level: Probability that the true mean lies in the interval, between 0 and 1.

        Returns:
            Lowest and highest fraction of `melanin` and `hemoglobin`. Empty if there is no skin.

        Raises:
            InputError: The level is no such probability.

        Example:
            >>> from skimage.data import astronaut
            >>> from skinnet import Decomposer
            >>> face = Decomposer(threads=1)(astronaut())
            >>> low, high = face.interval()["melanin"]
            >>> low < face.means["melanin"] < high
            True
        """
        find_factor(0.0, level)  # refuses a level also where there is no skin
        return {
            name: find_interval(mean, self._log_sds[name], self._find_top(name), level)
            for name, mean in self.means.items()
        }

    def indices(self, level: float = LEVEL) -> SkinIndices | None:
        """Compute colour, typology angle, instrument indices and nearest tone of the mean skin.

        They are those of skin with the mean pigments; `compute_indices` says how the intervals are
        found. Those of parts of the face are in `regions`.

        Args:
            level: Probability that a true number lies in its interval, between 0 and 1.

        Returns:
            The indices; None if there is no skin, or if the model's fractions do not belong to the
            preset `measured`.

        Raises:
            InputError: The level is no such probability.

        Example:
            >>> from skimage.data import astronaut
            >>> from skinnet import Decomposer
            >>> indices = Decomposer(threads=1)(astronaut()).indices()
            >>> low, high = indices.typology_angle.interval
            >>> low < indices.typology_angle.value < high
            True
        """
        find_factor(0.0, level)  # refuses a level also where there is no skin
        means = self.means.get("melanin"), self.means.get("hemoglobin")
        return _find_indices(self.model.get("optics"), means, self.uncertainty.face, level)

    @cached_property
    def regions(self) -> dict[str, RegionSummary]:
        """Melanin and hemoglobin in regions of the face.

        Of each there are mean, standard deviation over pixels, median, and how certain the mean is.
        They are forehead, left and right cheek (the person's), nose, lips, chin, neck and eyelids.
        Each has `share`, the part of it that is skin. Of a region that hair, cloth or the head's
        turn hides the pigments are None. Empty if no face was looked for.

        Example:
            >>> from skimage.data import astronaut
            >>> from skinnet import Decomposer
            >>> regions = Decomposer(threads=1)(astronaut()).regions
            >>> 0.01 < regions["nose"].melanin.median < 0.1
            True
        """
        parts = {} if self.face_parts is None else self.face_parts.regions
        return _Regions((name, self._summarise_region(part)) for name, part in parts.items())

    def _summarise_region(self, region: FaceRegion) -> RegionSummary:
        box = region.patch.box
        read = region.patch.inside & (self.mask[box.slices] > SKIN_THRESHOLD)
        rows, columns = np.nonzero(read)
        log_sds = list(self.uncertainty.face)
        if rows.size:
            log_sds = self.uncertainty.of_region(self.box, rows + box.top, columns + box.left)
        melanin, hemoglobin = (
            Pigment(getattr(self, name)[box.slices], log_sd, self._find_top(name))
            for name, log_sd in zip(PIGMENTS, log_sds, strict=True)
        )
        optics = self.model.get("optics")
        return summarise_region(region, read, melanin, hemoglobin, optics)

    @property
    def _log_sds(self) -> dict[str, float]:
        return dict(zip(PIGMENTS, self.uncertainty.face, strict=True))

    def _find_top(self, pigment: str) -> float:
        return self.output_info[pigment].range[1]
