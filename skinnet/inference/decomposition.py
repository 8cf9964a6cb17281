"""What is read from one photograph: maps, light, camera, and their summary."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from skinnet._version import __version__
from skinnet.images.box import Box
from skinnet.inference.onnx_model import OutputInfo

SKIN = 0.5
"""Least mask of what is counted as skin."""


@dataclass(frozen=True, eq=False)
class Decomposition:
    """A photograph of skin, taken apart. Maps are float32 [H, W] of the photograph's size.

    image = shading * skin(melanin, hemoglobin) + specular + offset in linear RGB, under `light` and
    seen by `camera`; with detail this holds for every pixel of skin. `reconstruction` is made with
    the network's own offset, the photograph by the share that the mask leaves: what else skin does
    not explain is not in it.
    Outside `box` nothing was looked at: maps are 0 there, and `reconstruction` is the photograph
    itself.

    `melanin`, `hemoglobin`: volume fractions of melanosomes in the epidermis and of blood in the
    dermis, in [0, 1]; `shading` and `specular` relative to the light; `mask`: how surely a pixel is
    skin, in [0, 1]; `offset` [H, W, 3]: linear sRGB that skin does not explain; `light`: weight of
    each light by name, of unit sum, and `temperature_k`, that of its daylight; `camera`:
    `components` in standard deviations and `white_balance`, the errors `r_over_g` and `b_over_g` as
    ratios; `reconstruction`: uint8 sRGB [H, W, 3].
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
    outputs: Mapping[str, OutputInfo]
    model: dict[str, str]

    def maps(self) -> dict[str, NDArray[np.float32]]:
        """Every map [H, W] by name, the offset's three channels apart."""
        names = ("melanin", "hemoglobin", "shading", "specular", "mask")
        channels = {f"offset_{name}": self.offset[..., i] for i, name in enumerate("rgb")}
        return {name: getattr(self, name) for name in names} | channels

    def output(self, name: str) -> OutputInfo:
        """Unit, range and description of a map of `maps()`."""
        return self.outputs[name.removesuffix("_r").removesuffix("_g").removesuffix("_b")]

    def summary(self) -> dict[str, Any]:
        """Numbers that JSON can hold: statistics of each map over skin, light and camera.

        `skin_share` is the part of the box that is skin. Where there is none, statistics are None.
        """
        skin = self.mask > SKIN
        height, width = skin.shape
        maps = {name: value for name, value in self.maps().items() if name != "mask"}
        return {
            "photo": {"width": width, "height": height},
            "box": self.box._asdict(),
            "skin_share": _short(float(np.mean(skin[self.box.slices]))),
            "maps": {
                name: {"unit": self.output(name).unit} | _statistics(value[skin])
                for name, value in maps.items()
            },
            "light": _shortened(self.light),
            "camera": _shortened(self.camera),
            "version": __version__,
            "model": self.model,
        }


def _statistics(values: NDArray[np.float32]) -> dict[str, float | None]:
    if values.size == 0:
        return dict.fromkeys(("mean", "std", "p5", "p95"))
    p5, p95 = np.percentile(values, [5, 95])
    wide = values.astype(np.float64)
    numbers = {"mean": wide.mean(), "std": wide.std(), "p5": p5, "p95": p95}
    return {name: _short(float(number)) for name, number in numbers.items()}


def _shortened(numbers: Any) -> Any:
    if isinstance(numbers, dict):
        return {name: _shortened(value) for name, value in numbers.items()}
    return [_short(number) for number in numbers] if isinstance(numbers, list) else _short(numbers)


def _short(number: float) -> float:
    return float(f"{number:.6g}")
