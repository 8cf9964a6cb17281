"""The result for one photograph: maps, light, camera, and their summary."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from skinnet._version import __version__
from skinnet.errors import InputError
from skinnet.images.box import Box
from skinnet.images.colour_space import ColourSpace
from skinnet.images.faces._face_parts import FaceParts, FaceRegion
from skinnet.images.faces._face_regions import REGION_NAMES
from skinnet.images.faces._outlines import Patch
from skinnet.images.resizing import resize
from skinnet.inference._index_summary import SkinIndices
from skinnet.inference._regions import Pigment, RegionSummary, summarise_region
from skinnet.inference._uncertainty import (
    LEVEL,
    PIGMENTS,
    Uncertainty,
    describe_mean,
    find_factor,
    find_interval,
    summarise_mean,
)
from skinnet.inference.indices import _find_indices
from skinnet.inference.onnx_model import OutputInfo

SKIN_THRESHOLD = 0.5
"""Pixels with a larger mask are counted as skin."""

MAP_FILES = (
    *("melanin", "hemoglobin", "shading", "specular", "mask"),
    *("offset_r", "offset_g", "offset_b"),
    *(f"{pigment}_sd" for pigment in PIGMENTS),
)
"""Names of the maps [H, W], and how the names of their files end."""


@dataclass(frozen=True, eq=False, repr=False)
class Decomposition:
    """Maps of the skin in one photograph, its light and its camera.

    image = shading * skin(melanin, hemoglobin) + specular + offset in linear RGB, under `light` and
    with `camera`. With detail this holds for every pixel of skin. Maps are 0
    outside `box`, and outside of the turned square around a tilted head.

    Attributes:
        melanin: Volume fraction of melanosomes in the epidermis, float32 [H, W] in [0, 1].
        hemoglobin: Volume fraction of blood in the dermis, float32 [H, W] in [0, 1].
        shading: Diffuse shading relative to the light, float32 [H, W].
        specular: Specular reflection relative to the light, float32 [H, W].
        mask: Probability of skin, float32 [H, W] in [0, 1].
        offset: Colour that the skin model does not explain, linear sRGB, float32 [H, W, 3].
        light: Weight of each light by name, with sum 1, and `temperature_k`, the colour temperature
            of the daylight in kelvin.
        camera: `components`, the camera's principal components in standard deviations, and
            `white_balance`, its errors as the ratios `r_over_g` and `b_over_g`.
        reconstruction: uint8 sRGB [H, W, 3]; the model's picture of skin with the network's offset,
            blended with the decoder's picture off skin; the photograph itself where nothing was
            read.
        box: The part of the photograph that was read; of a tilted head, the upright rectangle
            around the turned square that was read.
        output_info: Unit, range and description of each map of the network; `describe_map` has
            those of the maps here.
        uncertainty: Standard deviations of the natural logarithms of melanin and hemoglobin at the
            network's resolution, which `melanin_sd`, `hemoglobin_sd` and `interval` are made of.
        colour_space: The colour space in which the photograph was, and how that is known.
        notes: Sentences that the user should read, such as what was assumed of the photograph.
        model: `version` and `trained_on` of the encoder, and `optics`, the preset of the skin's
            constants to which its fractions belong: `SkinDecoder(model["optics"])` renders them.
        face_id: Number of the face, from 1, from left to right among all faces that were found in
            the photograph; None if no face was looked for.
        faces_found: Number of faces that were found in the photograph; None if none was looked for.
        face_parts: Where the parts of the face are; None if no face was looked for. It is what
            `landmarks`, `regions`, `sclera` and `teeth` are made of.
        tilt: Angle in degrees by which the head is turned clockwise; None if no face was looked
            for.
        pixels_read: Number of pixels in the box that were read; None for all of them.
        capture_known: Names of the parts of the capture that were given, such as "white_balance",
            or that a RAW file tells.
        exif: What EXIF states of the shot: `camera`, `flash` (whether it fired), `white_balance`
            (auto or manual) and `light_source`; None is what it does not state.
        skin_chromaticity: Log R/G and log B/G of the mean colour of skin in the photograph, in
            linear sRGB; None without skin.

    Example:
        >>> from skimage.data import astronaut
        >>> from skinnet import Decomposer
        >>> Decomposer(threads=1)(astronaut(), detail=False)
        <Decomposition 512 x 512: melanin 0.033 (90%: 0.021 to 0.053),
        hemoglobin 0.03 (90%: 0.016 to 0.055), 17% is skin>
    """

    melanin: NDArray[np.float32]
    hemoglobin: NDArray[np.float32]
    shading: NDArray[np.float32]
    specular: NDArray[np.float32]
    mask: NDArray[np.float32]
    offset: NDArray[np.float32]
    light: dict[str, float]
    camera: dict[str, Any]
    reconstruction: NDArray[np.uint8]
    box: Box
    output_info: Mapping[str, OutputInfo]
    model: dict[str, str]
    uncertainty: Uncertainty
    colour_space: ColourSpace = ColourSpace("sRGB", "assumed")
    notes: tuple[str, ...] = ()
    face_id: int | None = None
    faces_found: int | None = None
    face_parts: FaceParts | None = None
    tilt: float | None = None
    pixels_read: int | None = None
    capture_known: tuple[str, ...] = ()
    exif: Mapping[str, Any] = field(default_factory=dict)
    skin_chromaticity: tuple[float, float] | None = None

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

    @property
    def melanin_sd(self) -> NDArray[np.float32]:
        """Standard deviation of each pixel's melanin, float32 [H, W].

        To first order it is the fraction times the standard deviation of its natural logarithm. It
        is 0 where melanin is, and is made anew each time, to save memory.
        """
        return self._make_sd_map("melanin")

    @property
    def hemoglobin_sd(self) -> NDArray[np.float32]:
        """Standard deviation of each pixel's hemoglobin, float32 [H, W], as of melanin."""
        return self._make_sd_map("hemoglobin")

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

    @property
    def landmarks(self) -> NDArray[np.float32] | None:
        """Columns and rows of the 478 points of MediaPipe's face mesh, float32 [478, 2].

        They are in pixels from the photograph's upper left corner, so that the centre of its first
        pixel is (0.5, 0.5). The last ten are the irises. None if no face was looked for.
        """
        return None if self.face_parts is None else self.face_parts.landmarks

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
        return {name: self._summarise_region(region) for name, region in parts.items()}

    @property
    def sclera(self) -> NDArray[np.bool_]:
        """Mask of the whites of the eyes, for the colour of the light, bool [H, W].

        It is empty where eyes are closed, turned away, or narrower than 24 pixels.
        """
        return self._paste(() if self.face_parts is None else self.face_parts.sclera)

    @property
    def teeth(self) -> NDArray[np.bool_]:
        """Mask of the teeth, bool [H, W].

        It is empty if the mouth is closed, or narrower than 24 pixels.
        """
        return self._paste(() if self.face_parts is None else self.face_parts.teeth)

    def region_mask(self, name: str) -> NDArray[np.bool_]:
        """Mask the pixels of a region of the face that `regions` counts.

        Args:
            name: A key of `regions`.

        Returns:
            bool [H, W].

        Raises:
            InputError: There is no region of this name, or no face was looked for.

        Example:
            >>> from skimage.data import astronaut
            >>> from skinnet import Decomposer
            >>> decomposition = Decomposer(threads=1)(astronaut(), detail=False)
            >>> nose = decomposition.region_mask("nose")
            >>> bool(nose.sum() == decomposition.regions["nose"].pixels)
            True
        """
        if name not in REGION_NAMES:
            raise InputError(f"The regions of a face are {', '.join(REGION_NAMES)}; got {name!r}.")
        if self.face_parts is None:
            raise InputError(f"No face was looked for, so there is no {name}; leave out region.")
        patch = self.face_parts.regions[name].patch
        skin = self.mask[patch.box.slices] > SKIN_THRESHOLD
        return self._paste([Patch(patch.box, patch.inside & skin)])

    def maps(self) -> dict[str, NDArray[np.float32]]:
        """Return all maps by name.

        Returns:
            Maps [H, W]; the channels of the offset are `offset_r`, `offset_g` and `offset_b`.
        """
        return {name: self.get_map(name) for name in MAP_FILES}

    def get_map(self, name: str) -> NDArray[np.float32]:
        """Return one map by its name.

        Args:
            name: A key of `maps()`.

        Returns:
            The map [H, W].
        """
        base, _, channel = name.rpartition("_")
        if base == "offset":
            return self.offset[..., "rgb".index(channel)]
        values: NDArray[np.float32] = getattr(self, name)
        return values

    def describe_map(self, name: str) -> OutputInfo:
        """Return unit, range and description of a map.

        Args:
            name: A key of `maps()`.

        Returns:
            The entry of `output_info`; standard deviations have the unit of their pigment.
        """
        if name.endswith("_sd"):
            unit, ends, description = self.output_info[name.removesuffix("_sd")]
            return OutputInfo(unit, ends, f"standard deviation of: {description}")
        return self.output_info[name.removesuffix("_r").removesuffix("_g").removesuffix("_b")]

    def summary(self) -> dict[str, Any]:
        """Summarise the maps over skin, with light and camera, as numbers for JSON.

        Returns:
            `id` (of the face), `faces_found`, `photo` (size), `colour_space` (`name`,
            `known_from`), `notes`, `box`, `skin_share` (share of skin in what
            was read), `tilt` (degrees; None without a face), `maps` (`unit`, `mean`, `std`, `p5`
            and `p95` of each; None where there is no skin), `pigments` (`mean` of `melanin` and
            `hemoglobin` with its `sd` and the `interval` of the probability `level`), `indices`
            (`l_star`, `a_star`, `b_star`, `typology_angle`, `melanin_index` and `erythema_index`
            with `value`, `sd` and 90 % `interval`, `typology_group`, and `monk_tone` with `value`,
            `interval` and `delta_e`; None as in `indices`),
            `regions` (of each `melanin` and `hemoglobin` with `mean`, `std`, `median`, `sd` and
            `interval`, which are None where it is hidden, `share`, `pixels` and `indices`),
            `landmarks` (a
            list of [x, y] to a tenth of a pixel; None without a face), `light`, `camera`,
            `capture_known` (what was given of them, or a RAW file tells), `exif` (what EXIF states
            of the shot), `version` and `model`.
        """
        skin = self.mask > SKIN_THRESHOLD
        height, width = skin.shape
        names = [name for name in MAP_FILES if name != "mask"]
        return {
            "id": self.face_id,
            "faces_found": self.faces_found,
            "photo": {"width": width, "height": height},
            "colour_space": {
                "name": self.colour_space.name,
                "known_from": self.colour_space.known_from,
            },
            "notes": list(self.notes),
            "box": self.box._asdict(),
            "skin_share": _round(self.skin_share),
            "tilt": None if self.tilt is None else round(self.tilt, 1),
            "maps": {
                name: {"unit": self.describe_map(name).unit} | _summarise(self.get_map(name)[skin])
                for name in names
            },
            "pigments": {name: self._summarise_pigment(name) for name in PIGMENTS},
            "indices": None if (indices := self.indices()) is None else indices.to_json(),
            "regions": {name: region.to_json() for name, region in self.regions.items()},
            "landmarks": None if self.landmarks is None else _round_points(self.landmarks),
            "light": _round_all(self.light),
            "camera": _round_all(self.camera),
            "capture_known": list(self.capture_known),
            "exif": dict(self.exif),
            "version": __version__,
            "model": self.model,
        }

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

    def _summarise_pigment(self, name: str) -> dict[str, Any]:
        mean = self.means.get(name)
        summary = summarise_mean(mean, self._log_sds[name], self._find_top(name))
        rounded: dict[str, Any] = _round_all(summary)
        return rounded

    def _make_sd_map(self, pigment: str) -> NDArray[np.float32]:
        sds = np.zeros_like(self.mask)
        box = self.box
        log_sd = self.uncertainty.of_pixels(pigment)
        sds[box.slices] = resize(log_sd, box.width, box.height)
        sds *= getattr(self, pigment)
        return sds

    def _paste(self, patches: Sequence[Patch]) -> NDArray[np.bool_]:
        """A mask of the photograph's size."""
        mask = np.zeros(self.mask.shape, bool)
        for patch in patches:
            mask[patch.box.slices] |= patch.inside
        return mask


def _round_points(points: NDArray[np.float32]) -> list[list[float]]:
    return [[round(x, 1), round(y, 1)] for x, y in points.tolist()]


def _summarise(values: NDArray[np.float32]) -> dict[str, float | None]:
    if values.size == 0:
        return dict.fromkeys(("mean", "std", "p5", "p95"))
    p5, p95 = np.percentile(values, [5, 95])
    wide = values.astype(np.float64)
    numbers = {"mean": wide.mean(), "std": wide.std(), "p5": p5, "p95": p95}
    return {name: _round(float(number)) for name, number in numbers.items()}


def _round_all(numbers: Any) -> Any:
    if isinstance(numbers, dict):
        return {name: _round_all(value) for name, value in numbers.items()}
    if isinstance(numbers, list):
        return [_round(number) for number in numbers]
    return None if numbers is None else _round(numbers)


def _round(number: float) -> float:
    """Six significant digits."""
    return float(f"{number:.6g}")
