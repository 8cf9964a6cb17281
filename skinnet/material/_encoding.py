"""Stored values of a texture to linear RGB and back, and offsets in steps of its bits."""

from functools import cached_property

import numpy as np
from jaxtyping import Float32, Shaped

from skinnet.images.srgb import linear_to_srgb, srgb_to_linear


class Encoding:
    """How a texture stores linear RGB.

    Args:
        type_: uint8, uint16, half or float.
        linear: Whether the stored values are linear.
    """

    def __init__(self, type_: str, linear: bool) -> None:
        self.type, self.linear = type_, linear
        names = {"half": np.float16, "float": np.float32}
        self.dtype = np.dtype(names.get(type_, type_))

    @property
    def is_float(self) -> bool:
        """Whether stored values are floating-point numbers."""
        return self.dtype.kind == "f"

    @property
    def _top(self) -> int:
        """The largest stored integer."""
        return (1 << 8 * self.dtype.itemsize) - 1

    @cached_property
    def _table(self) -> Float32[np.ndarray, "values"]:
        """Linear values of all stored integers."""
        values = np.arange(self._top + 1) / self._top
        return np.asarray(values if self.linear else _from_srgb(values), np.float32)

    def decode(self, stored: Shaped[np.ndarray, "*texels"]) -> Float32[np.ndarray, "*texels"]:
        """Convert stored values to linear ones."""
        if not self.is_float:
            return self._table.take(stored)
        values = stored.astype(np.float32)
        return values if self.linear else _from_srgb(values)

    def encode(self, linear: Float32[np.ndarray, "*texels"]) -> Shaped[np.ndarray, "*texels"]:
        """Convert linear values to stored ones; integers are clipped."""
        if self.is_float:
            values = linear if self.linear else linear_to_srgb(linear)
            return np.asarray(values, self.dtype)
        clipped = linear.clip(0, 1)
        values = clipped if self.linear else linear_to_srgb(clipped)
        return np.asarray(np.rint(values * self._top), self.dtype)

    def normalise(self, stored: Shaped[np.ndarray, "*texels"]) -> Float32[np.ndarray, "*texels"]:
        """Scale stored values so that white is 1."""
        scale = 1 if self.is_float else self._top
        return np.asarray(stored.astype(np.float32) / np.float32(scale))

    def subtract(
        self, stored: Shaped[np.ndarray, "*texels"], skin: Float32[np.ndarray, "*texels"]
    ) -> Shaped[np.ndarray, "*texels"]:
        """Compute what is stored of an offset: the stored value less that of the model's skin.

        Integers count steps from the middle of their range and wrap around, so that no offset is
        rounded or clipped. Floating-point offsets are linear, with 32 bits.
        """
        if self.is_float:
            return np.asarray(self.decode(stored) - skin, np.float32)
        return np.asarray(stored - self.encode(skin) + self.middle, self.dtype)

    def add(
        self, offset: Shaped[np.ndarray, "*texels"], skin: Float32[np.ndarray, "*texels"]
    ) -> Shaped[np.ndarray, "*texels"]:
        """Compute the stored value of an albedo from its stored offset."""
        if self.is_float:
            linear = offset.astype(np.float32) + skin
            return np.asarray(linear if self.linear else linear_to_srgb(linear), self.dtype)
        return np.asarray(offset - self.middle + self.encode(skin), self.dtype)

    @property
    def middle(self) -> Shaped[np.ndarray, ""]:
        """The stored offset of nothing, as a number of the offset's type."""
        half = 0 if self.is_float else (self._top + 1) // 2
        return np.asarray(half, self.dtype)


def _from_srgb(values: Shaped[np.ndarray, "*texels"]) -> Float32[np.ndarray, "*texels"]:
    return np.asarray(srgb_to_linear(values.astype(np.float32)))
