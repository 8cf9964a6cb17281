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

from skinnet.appearance._feature_blocks import compute_block_width
from skinnet.appearance.colour import CHANNELS, SkinColour
from skinnet.appearance.skin_texture import SkinTexture
from skinnet.errors import InputError
from skinnet.files._content import explain_format
from skinnet.files._npz import map_npy
from skinnet.files._reading import MOST_TEXT, read_file

_FEATURES, _MASKS, _STATE = "features.npy", "masks.npy", "stack.json"

_STACK_FORMAT = 1
"""Version of the folder's layout."""


@dataclass(frozen=True, eq=False)
class _Cover:
    """The texels that a model is built on.

    `left_out` is the number of texels of the drawn mask that too few subjects have. `filled` is the
    number of values inside `mask` that a subject lacks; the mean of the others replaces them.
    """

    mask: Bool[np.ndarray, "size size"]
    left_out: int
    filled: int

    def __str__(self) -> str:
        return (
            f"{self.mask.sum()} of {self.mask.size} texels are modelled, {self.left_out} are left "
            f"out because too few subjects have them, and {self.filled} missing values are the "
            "mean of the other subjects"
        )


@dataclass(frozen=True, eq=False)
class SubjectStack:
    """The features of many people in one texture space, in a folder of memory-mapped arrays.

    `write_stack` makes one and `open_stack` opens it. The folder holds features.npy, float32
    [subjects, 5, n * n] in the order of `CHANNELS`, and masks.npy, bool [subjects, n * n].

    Args:
        folder: The folder of the arrays.
        names: Names of the subjects.
        size: Texels along a side, n.
        colour: Light, camera and calibration under which all subjects were inverted.
    """

    folder: Path
    names: tuple[str, ...]
    size: int
    colour: SkinColour

    def texture(self, index: int) -> SkinTexture:
        """Read one subject.

        Args:
            index: Number of the subject, from 0.

        Returns:
            The maps of the subject.
        """
        square = (self.size, self.size)
        blood, mel, *offset = np.array(self.array(_FEATURES)[index]).reshape(-1, *square)
        mask = np.array(self.array(_MASKS)[index]).reshape(square)
        return SkinTexture(mel, blood, np.stack(offset, -1), mask, self.names[index])

    def cover(
        self, share: float = 1.0, within: Bool[np.ndarray, "size size"] | None = None
    ) -> _Cover:
        """Choose the texels that enough subjects have.

        Args:
            share: Share of the subjects that must have a texel, in (0, 1].
            within: Drawn mask; texels outside it are left out. None: all texels.

        Returns:
            The `mask` and the counts that led to it.

        Raises:
            InputError: If the share is outside (0, 1], the mask has another size, or no texel is
                left.
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
        return _Cover(mask, left_out, int((len(self.names) - known[mask]).sum()))

    def read_blocks(
        self, mask: Bool[np.ndarray, "size size"], width: int | None = None
    ) -> "_StackBlocks":
        """Prepare to read the features of the texels in a mask, block by block.

        Args:
            mask: Texels to read.
            width: Texels of the texture that are read at a time; None: as many as memory allows.

        Returns:
            An iterable of blocks [subjects, 5, texels]; a missing value is the mean of the others.

        Raises:
            InputError: If the mask has another size or holds a texel that no subject has.
        """
        self._check_size(mask)
        if lost := int((self._known[mask.ravel()] == 0).sum()):
            raise InputError(
                f"{lost} texels of the mask are known in no subject of {self.folder}; "
                "use the mask that cover() gives."
            )
        return _StackBlocks(self, mask, width)

    def _check_size(self, mask: Bool[np.ndarray, "size size"]) -> None:
        if mask.shape != (self.size, self.size):
            raise InputError(
                f"The mask is {mask.shape[1]} x {mask.shape[0]} texels and the subjects of "
                f"{self.folder} are {self.size} x {self.size}; warp them to one resolution."
            )

    @cached_property
    def _known(self) -> Int[np.ndarray, "texels"]:
        """Number of subjects that have each texel."""
        known = np.zeros(self.size**2, np.int64)
        for index in range(len(self.names)):
            known += self.array(_MASKS)[index]
        return known

    def array(self, name: str) -> NDArray[Any]:
        """Map one of the arrays of the folder into memory.

        Args:
            name: features.npy or masks.npy.

        Returns:
            The memory-mapped array.
        """
        return np.asarray(map_npy(self.folder / name))


class _StackBlocks:
    """`FeatureBlocks` of a stack inside a mask; a missing value is the mean of the others."""

    def __init__(
        self, stack: SubjectStack, mask: Bool[np.ndarray, "size size"], width: int | None = None
    ) -> None:
        self.stack, self.inside = stack, mask.ravel()
        self.shape = (len(stack.names), len(CHANNELS), int(mask.sum()))
        self.width = width or compute_block_width(*self.shape[:2])

    def __iter__(self) -> Iterator[Float32[np.ndarray, "subjects 5 texels"]]:
        for start in range(0, self.inside.size, self.width):
            span = slice(start, start + self.width)
            if (inside := self.inside[span]).any():
                # A new map for each block lets the system drop the pages of the last one.
                features = self.stack.array(_FEATURES)[:, :, span][:, :, inside]
                yield _fill(features, self.stack.array(_MASKS)[:, span][:, inside])


def _fill(
    features: Float32[np.ndarray, "subjects 5 texels"], masks: Bool[np.ndarray, "subjects texels"]
) -> Float32[np.ndarray, "subjects 5 texels"]:
    if masks.all():
        return features
    mean = features.sum(0, dtype=np.float64) / masks.sum(0)
    filled: Float32[np.ndarray, "subjects 5 texels"] = np.where(
        masks[:, None], features, mean.astype(np.float32)
    )
    return filled


def open_stack(folder: Path) -> SubjectStack:
    """Open a stack that `write_stack` has finished; see there for an example.

    Args:
        folder: The folder of the stack.

    Returns:
        The stack.

    Raises:
        InputError: If the folder holds no stack, an unfinished or a damaged one.
    """
    state = _read_state(folder)
    try:
        names, colour = tuple(state["names"]), SkinColour.from_record(state["colour"])
        done, size = int(state["done"]), int(state["size"])
    except (KeyError, TypeError, ValueError) as error:
        raise InputError(f"{folder} holds no stack of subjects; make it again.") from error
    if done < len(names):
        raise InputError(
            f"{folder} holds {done} of {len(names)} subjects; run the command that makes it again, "
            "which resumes."
        )
    if not _is_whole(folder, len(names), size):
        raise InputError(f"The arrays in {folder} are damaged; delete the folder, make it again.")
    return SubjectStack(folder, names, size, colour)


def _read_state(folder: Path) -> dict[str, Any]:
    """Read the progress and description of a folder's stack."""
    try:
        state = json.loads(read_file(folder / _STATE, MOST_TEXT))
    except (OSError, ValueError) as error:
        raise InputError(f"{folder} holds no stack of subjects ({error}).") from error
    state = state if isinstance(state, dict) else {}
    if (found := state.get("format", _STACK_FORMAT)) != _STACK_FORMAT:
        raise InputError(
            f"{folder} holds a stack of format {found}, and this skinnet reads format "
            f"{_STACK_FORMAT}; make it again in another folder, or use the version that wrote it "
            f"({explain_format(found, _STACK_FORMAT, state.get('skinnet'))})."
        )
    return state


def _is_whole(folder: Path, subjects: int, size: int) -> bool:
    """Tell whether both arrays are there and have the shapes of so many subjects."""
    shapes = {_FEATURES: (subjects, len(CHANNELS), size**2), _MASKS: (subjects, size**2)}
    try:
        return all(map_npy(folder / name).shape == shape for name, shape in shapes.items())
    except (OSError, ValueError):
        return False
