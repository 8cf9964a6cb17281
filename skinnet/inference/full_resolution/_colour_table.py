"""The colours of bare skin under one light and camera, tabulated from the decoder's ONNX file."""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from skinnet.images.srgb import srgb_to_linear
from skinnet.inference.onnx_model import CAPTURE_NAMES, OnnxModel

NODES = (192, 128)
"""Nodes in melanin and hemoglobin; colours between them are within 2e-4 of the decoder's."""

SPACING = (0.02, 0.02)
"""Fractions below which nodes stand evenly, above which by ratio, as those of `SkinLookup`."""

_DIM = 0.25
"""Shading under which the table is made, so that no colour of it is clipped at white."""

_DARK = 1e-4


class ColourTable:
    """Linear RGB of skin over melanin and hemoglobin, bilinear between nodes."""

    def __init__(self, colours: NDArray[np.float32], top: tuple[float, float]):
        """`colours` [melanin, hemoglobin, 3] at `nodes` of the fractions from 0 to `top`."""
        self.shape, self.top = colours.shape[:2], top
        self._flat = np.ascontiguousarray(colours.reshape(-1, 3), np.float32)

    def __call__(
        self, melanin: NDArray[np.float32], hemoglobin: NDArray[np.float32]
    ) -> NDArray[np.float32]:
        """Colours [*shape, 3] at fractions [*shape]."""
        row, down = self._place(melanin.ravel(), 0)
        column, right = self._place(hemoglobin.ravel(), 1)
        first = row * self.shape[1] + column
        left, other = (
            _between(self._flat.take(at, 0), self._flat.take(at + self.shape[1], 0), down)
            for at in (first, first + 1)
        )
        return _between(left, other, right).reshape(*melanin.shape, 3)

    def slopes(
        self, melanin: NDArray[np.float32], hemoglobin: NDArray[np.float32]
    ) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        """Derivatives [*shape, 3] of the logarithm of colour by melanin and by the root of
        hemoglobin, in both of which it is nearly straight."""
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
        return np.log(np.maximum(self(melanin, hemoglobin), np.float32(_DARK)))

    def _place(
        self, fraction: NDArray[np.float32], axis: int
    ) -> tuple[NDArray[np.int32], NDArray[np.float32]]:
        """The node before each fraction, and the way on to the next one, [pixels, 1]."""
        spacing, last = SPACING[axis], self.shape[axis] - 1
        scale = np.float32(last / np.log1p(self.top[axis] / spacing))
        place = np.log1p(np.maximum(fraction, 0) * np.float32(1 / spacing)) * scale
        node = np.minimum(place, last - 1).astype(np.int32)
        return node, np.minimum(place - node, 1)[:, None].astype(np.float32)


def tabulate(
    decoder: OnnxModel, codes: Mapping[str, NDArray[np.float32]], top: tuple[float, float]
) -> ColourTable:
    """The table for the light and camera of one photograph's `codes`, up to the fractions `top`."""
    axes = [
        nodes(count, high, spacing)
        for count, high, spacing in zip(NODES, top, SPACING, strict=True)
    ]
    melanin, hemoglobin = (grid[None] for grid in np.meshgrid(*axes, indexing="ij"))
    bare = {
        "melanin": np.ascontiguousarray(melanin),
        "hemoglobin": np.ascontiguousarray(hemoglobin),
        "shading": np.full_like(melanin, _DIM),
        "specular": np.zeros_like(melanin),
        "offset": np.zeros((*melanin.shape, 3), np.float32),
    }
    image = decoder.run(bare | {name: codes[name] for name in CAPTURE_NAMES})["image"][0]
    return ColourTable(srgb_to_linear(image) / np.float32(_DIM), top)


def nodes(count: int, top: float, spacing: float) -> NDArray[np.float32]:
    """Fractions from 0 to `top` at even steps of log(1 + f / spacing)."""
    steps = np.linspace(0, np.log1p(top / spacing), count)
    fractions: NDArray[np.float32] = (spacing * np.expm1(steps)).astype(np.float32)
    return fractions


def _between(
    a: NDArray[np.float32], b: NDArray[np.float32], share: NDArray[np.float32]
) -> NDArray[np.float32]:
    b -= a
    b *= share
    b += a
    return b
