"""Maps of the skin in one photograph, and what is known of them."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from skinnet.errors import InputError
from skinnet.images.box import Box
from skinnet.images.colour_space import ColourSpace
from skinnet.images.faces._face_parts import FaceParts
from skinnet.images.resizing import resize
from skinnet.inference._pigment_edit import EditSource
from skinnet.inference._uncertainty import PIGMENTS, Uncertainty
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
class SkinMaps:
    """The maps of a `Decomposition`, which describes them."""

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
    provider: str = "cpu"
    _source: EditSource | None = None

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

        Raises:
            InputError: There is no map of this name.
        """
        _check_name(name)
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

        Raises:
            InputError: There is no map of this name.
        """
        _check_name(name)
        if name.endswith("_sd"):
            unit, ends, description = self.output_info[name.removesuffix("_sd")]
            return OutputInfo(unit, ends, f"standard deviation of: {description}")
        return self.output_info[name.removesuffix("_r").removesuffix("_g").removesuffix("_b")]

    def _make_sd_map(self, pigment: str) -> NDArray[np.float32]:
        sds = np.zeros_like(self.mask)
        box = self.box
        log_sd = self.uncertainty.of_pixels(pigment)
        sds[box.slices] = resize(log_sd, box.width, box.height)
        sds *= getattr(self, pigment)
        return sds


def _check_name(name: str) -> None:
    if not isinstance(name, str) or name not in MAP_FILES:
        raise InputError(f"The maps are {', '.join(MAP_FILES)}; got {name!r:.60}.")
