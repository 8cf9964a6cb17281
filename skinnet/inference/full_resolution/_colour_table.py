"""Colours of bare skin under one light and camera, tabulated from the decoder's ONNX file."""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from skinnet.images.srgb import srgb_to_linear
from skinnet.inference.onnx_model import CAPTURE_NAMES, OnnxModel

NODES = (192, 128)
"""Nodes in melanin and hemoglobin; colours between them are within 2e-4 of the decoder's."""

_SHADING = 0.25
"""Shading at which the table is made, so that none of its colours is clipped at white."""

_MIN_COLOUR = 1e-4


class ColourTable:
    """Linear RGB of skin as a function of melanin and hemoglobin, bilinear between nodes.

    Nodes are evenly spaced in the square root of a fraction: they are densest at small fractions,
    where colours change fastest, and a square root is cheap. On 2^18 pixels a call takes 3/4 of the
    time of three calls of `scipy.ndimage.map_coordinates`, with the same results up to rounding.

    Args:
        colours: Linear RGB [melanin, hemoglobin, 3] at the nodes.
        top: Fractions of melanin and hemoglobin at the last nodes; the first ones are at 0.
    """

    def __init__(self, colours: NDArray[np.float32], top: tuple[float, float]) -> None:
        self.shape, self.top = colours.shape[:2], top
        self._flat = np.ascontiguousarray(colours.reshape(-1, 3), np.float32)

    def __call__(
        self, melanin: NDArray[np.float32], hemoglobin: NDArray[np.float32]
    ) -> NDArray[np.float32]:
        """Colours [*shape, 3] at fractions [*shape]."""
        row, down = self._locate(melanin.ravel(), 0)
        column, right = self._locate(hemoglobin.ravel(), 1)
        first = row * self.shape[1] + column
        left, other = (
            _blend_in_place(self._flat.take(at, 0), self._flat.take(at + self.shape[1], 0), down)
            for at in (first, first + 1)
        )
        return _blend_in_place(left, other, right).reshape(*melanin.shape, 3)

    def differentiate_log(
        self, melanin: NDArray[np.float32], hemoglobin: NDArray[np.float32]
    ) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        """Derivatives [*shape, 3] of log colour by melanin and by the square root of hemoglobin.

        Log colour is nearly linear in both.
        """
        root = np.sqrt(hemoglobin)
        step = 0.05 * melanin + 0.002, 0.05 * root + 0.01
        low, high = np.maximum(melanin - step[0], 0), np.minimum(melanin + step[0], self.top[0])
        by_melanin = self._log(high, hemoglobin) - self._log(low, hemoglobin)
        by_melanin /= (high - low)[..., None]
        low = np.maximum(root - step[1], 0)
        high = np.minimum(root + step[1], np.float32(self.top[1] ** 0.5))
        by_root = self._log(melanin, high**2) - self._log(melanin, low**2)
        return by_melanin, by_root / (high - low)[..., None]

    def _log(
        self, melanin: NDArray[np.float32], hemoglobin: NDArray[np.float32]
    ) -> NDArray[np.float32]:
        return np.log(np.maximum(self(melanin, hemoglobin), np.float32(_MIN_COLOUR)))

    def _locate(
        self, fraction: NDArray[np.float32], axis: int
    ) -> tuple[NDArray[np.int32], NDArray[np.float32]]:
        """The node below each fraction, and the share of the way to the next one, [pixels, 1]."""
        last = self.shape[axis] - 1
        place = np.sqrt(np.maximum(fraction, 0) * np.float32(last**2 / self.top[axis]))
        node = np.minimum(place, last - 1).astype(np.int32)
        return node, np.minimum(place - node, 1)[:, None].astype(np.float32)


def tabulate_colours(
    decoder: OnnxModel,
    encoder_outputs: Mapping[str, NDArray[np.float32]],
    top: tuple[float, float],
) -> ColourTable:
    """Tabulate colours for the light and camera of one photograph, up to the fractions `top`."""
    axes = [place_nodes(count, high) for count, high in zip(NODES, top, strict=True)]
    melanin, hemoglobin = (grid[None] for grid in np.meshgrid(*axes, indexing="ij"))
    bare = {
        "melanin": np.ascontiguousarray(melanin),
        "hemoglobin": np.ascontiguousarray(hemoglobin),
        "shading": np.full_like(melanin, _SHADING),
        "specular": np.zeros_like(melanin),
        "offset": np.zeros((*melanin.shape, 3), np.float32),
    }
    capture = {name: encoder_outputs[name] for name in CAPTURE_NAMES}
    image = decoder.run(bare | capture)["image"][0]
    return ColourTable(srgb_to_linear(image) / np.float32(_SHADING), top)


def place_nodes(count: int, top: float) -> NDArray[np.float32]:
    """Fractions from 0 to `top`, evenly spaced in their square root."""
    fractions: NDArray[np.float32] = (top * np.linspace(0, 1, count) ** 2).astype(np.float32)
    return fractions


def _blend_in_place(
    a: NDArray[np.float32], b: NDArray[np.float32], share: NDArray[np.float32]
) -> NDArray[np.float32]:
    """Compute a + share * (b - a) in place, in `b`; both are temporaries of the caller."""
    b -= a
    b *= share
    b += a
    return b
