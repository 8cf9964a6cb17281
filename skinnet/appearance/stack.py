"""The skin of many people in one texture space, on disk."""

import json
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Bool, Float32, Int
from numpy.typing import NDArray

from skinnet.appearance._feature_blocks import block_width
from skinnet.appearance.colour import CHANNELS, SkinColour
from skinnet.appearance.skin_texture import SkinTexture
from skinnet.errors import InputError

FEATURES, MASKS, STATE = "features.npy", "masks.npy", "stack.json"
"""Files of a stack."""


@dataclass(frozen=True, eq=False)
class Cover:
    """Which texels a model is built on: `mask` [n, n], and the counts that led to it.

    `left_out` texels are known in too few subjects, of those inside the drawn mask; `filled` texels
    of single subjects are in the mask and unknown: in the model they are the mean of the others.
    """

    mask: Bool[np.ndarray, "size size"]
    left_out: int
    filled: int

    def __str__(self) -> str:
        return (
            f"{self.mask.sum()} of {self.mask.size} texels are modelled, {self.left_out} that too "
            f"few subjects have are left out, and {self.filled} missing values take the mean"
        )


@dataclass(frozen=True, eq=False)
class SubjectStack:
    """The features of people in one texture space, in a folder of memory-mapped arrays.

    `features.npy` float32 [subjects, 5, n * n] in the order of `CHANNELS`, `masks.npy` bool
    [subjects, n * n]. All are inverted under the same `colour`. Made by `spool`.
    """

    folder: Path
    names: tuple[str, ...]
    size: int
    colour: SkinColour

    def texture(self, index: int) -> SkinTexture:
        """One subject."""
        square = (self.size, self.size)
        blood, mel, *offset = np.array(self.array(FEATURES)[index]).reshape(-1, *square)
        mask = np.array(self.array(MASKS)[index]).reshape(square)
        return SkinTexture(mel, blood, np.stack(offset, -1), mask, self.names[index])

    def cover(
        self, share: float = 1.0, within: Bool[np.ndarray, "rows columns"] | None = None
    ) -> Cover:
        """The texels that at least that share of the subjects has, inside a drawn mask if given.

        Raises `InputError` for a share outside (0, 1], a mask of another size, and if none is left.
        """
        if not 0 < share <= 1:
            raise InputError(
                f"The share of subjects that have a texel lies in (0, 1]; got {share}."
            )
        drawn = np.ones((self.size, self.size), bool) if within is None else within
        self._check_size(drawn)
        known = self._known.reshape(drawn.shape)
        mask = drawn & (known >= max(1, share * len(self.names) - 1e-9))
        if not mask.any():
            raise InputError(
                f"No texel is known in {share:.0%} of the {len(self.names)} subjects of "
                f"{self.folder} and inside the mask; allow a smaller share, or draw another mask."
            )
        left_out = int((drawn & (known > 0) & ~mask).sum())
        return Cover(mask, left_out, int((len(self.names) - known[mask]).sum()))

    def read_blocks(
        self, mask: Bool[np.ndarray, "rows columns"], width: int | None = None
    ) -> "_StackBlocks":
        """The features of the texels in a mask, read about `width` texels at a time.

        Raises `InputError` for a mask of another size, or a texel in it that no subject has.
        """
        self._check_size(mask)
        if lost := int((self._known[mask.ravel()] == 0).sum()):
            raise InputError(
                f"{lost} texels of the mask are known in no subject of {self.folder}; "
                "take the mask of its cover()."
            )
        return _StackBlocks(self, mask, width)

    def _check_size(self, mask: Bool[np.ndarray, "rows columns"]) -> None:
        if mask.shape != (self.size, self.size):
            raise InputError(
                f"The mask is {mask.shape[1]} x {mask.shape[0]} texels and the subjects of "
                f"{self.folder} are {self.size} x {self.size}; warp them to one resolution."
            )

    @cached_property
    def _known(self) -> Int[np.ndarray, "texels"]:
        """How many subjects have each texel."""
        known = np.zeros(self.size**2, np.int64)
        for index in range(len(self.names)):
            known += self.array(MASKS)[index]
        return known

    def array(self, name: str) -> NDArray[Any]:
        """One of the arrays, memory-mapped."""
        return np.asarray(np.load(self.folder / name, mmap_mode="r"))


class _StackBlocks:
    """`FeatureBlocks` of a stack's features inside a mask; an unknown texel is the mean of the others."""

    def __init__(
        self, stack: SubjectStack, mask: Bool[np.ndarray, "size size"], width: int | None = None
    ):
        self.stack, self.inside = stack, mask.ravel()
        self.shape = (len(stack.names), len(CHANNELS), int(mask.sum()))
        self.width = width or block_width(*self.shape[:2])

    def __iter__(self) -> Iterator[Float32[np.ndarray, "subjects 5 columns"]]:
        for start in range(0, self.inside.size, self.width):
            span = slice(start, start + self.width)
            if (inside := self.inside[span]).any():
                # Mapped anew for each block, so that what was read does not stay resident.
                features = self.stack.array(FEATURES)[:, :, span][:, :, inside]
                yield _fill(features, self.stack.array(MASKS)[:, span][:, inside])


def _fill(
    features: Float32[np.ndarray, "subjects 5 columns"], masks: Bool[np.ndarray, "subjects columns"]
) -> Float32[np.ndarray, "subjects 5 columns"]:
    if masks.all():
        return features
    mean = features.sum(0, dtype=np.float64) / masks.sum(0)
    filled: Float32[np.ndarray, "subjects 5 columns"] = np.where(
        masks[:, None], features, mean.astype(np.float32)
    )
    return filled


def open_stack(folder: Path) -> SubjectStack:
    """A finished stack. Raises `InputError` for anything else."""
    state = read_state(folder)
    try:
        names, colour = tuple(state["names"]), SkinColour.from_record(state["colour"])
        done, size = int(state["done"]), int(state["size"])
    except (KeyError, TypeError, ValueError) as error:
        raise InputError(f"{folder} holds no stack of subjects; make it again.") from error
    if done < len(names):
        raise InputError(
            f"{folder} holds {done} of {len(names)} subjects; run the command that makes it again "
            "to go on."
        )
    if not is_whole(folder, len(names), size):
        raise InputError(f"The arrays in {folder} are damaged; delete the folder, make it again.")
    return SubjectStack(folder, names, size, colour)


def read_state(folder: Path) -> dict[str, Any]:
    """What a folder says of its stack. Raises `InputError` if it says nothing."""
    try:
        state = json.loads((folder / STATE).read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise InputError(f"{folder} holds no stack of subjects ({error}).") from error
    return state if isinstance(state, dict) else {}


def is_whole(folder: Path, subjects: int, size: int) -> bool:
    """Whether the arrays are there, for so many subjects of that size."""
    shapes = {FEATURES: (subjects, len(CHANNELS), size**2), MASKS: (subjects, size**2)}
    try:
        return all(
            np.load(folder / name, mmap_mode="r").shape == shape for name, shape in shapes.items()
        )
    except (OSError, ValueError, EOFError):
        return False
