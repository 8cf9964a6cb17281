"""Features of many subjects, read one block of texels at a time."""

from collections.abc import Iterator
from typing import Protocol, runtime_checkable

import numpy as np
from jaxtyping import Float, Float32

from skinnet.errors import InputError

BLOCK_BYTES = 2**27
"""Size of a block of float32 features of all subjects; a pass holds a few blocks."""


@runtime_checkable
class FeatureBlocks(Protocol):
    """Features of all subjects, read one block of texels at a time, as often as needed.

    `shape` is [subjects, channels, texels], with one channel for each kind of feature.
    """

    shape: tuple[int, int, int]

    def __iter__(self) -> Iterator[Float32[np.ndarray, "subjects channels texels"]]: ...


class ArrayBlocks:
    """A matrix [subjects, features], perhaps a memmap, read `width` texels at a time.

    A row of features is `channels` runs of equal length.
    """

    def __init__(
        self,
        rows: Float[np.ndarray, "subjects features"],
        channels: int = 1,
        width: int | None = None,
    ) -> None:
        subjects, features = rows.shape
        if features % channels:
            raise InputError(f"{features} features cannot be split into {channels} equal blocks.")
        self.rows = rows
        self.shape = (subjects, channels, features // channels)
        self.width = width or compute_block_width(subjects, channels)

    def __iter__(self) -> Iterator[Float32[np.ndarray, "subjects channels texels"]]:
        folded = self.rows.reshape(self.shape)
        for start in range(0, self.shape[2], self.width):
            yield np.array(folded[:, :, start : start + self.width], np.float32)


def compute_block_width(subjects: int, channels: int) -> int:
    """Compute how many texels a block of `BLOCK_BYTES` holds."""
    return max(1, BLOCK_BYTES // (4 * subjects * channels))
