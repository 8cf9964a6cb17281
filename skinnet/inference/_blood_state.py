"""Another state of a face's blood, such as a flush, on top of what the encoder has read."""

from collections.abc import Mapping
from typing import Any, Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from skinnet.errors import InputError
from skinnet.images.box import Box


@runtime_checkable
class BloodState(Protocol):
    """A change of hemoglobin over a face, as `skinnet.appearance.DynamicModel.change` makes it."""

    @property
    def amounts(self) -> Mapping[str, float]:
        """The amount of each state, to be told."""

    def __call__(
        self,
        hemoglobin: NDArray[np.float32],
        landmarks: NDArray[np.floating],
        skin: NDArray[np.floating],
        most: float,
    ) -> NDArray[np.float32]:
        """Hemoglobin [h, w] of a face with landmarks [478, 2] in pixels of the map, up to `most`.

        `skin` is the probability of skin, [h, w].
        """


def check_state(state: Any, region: Any) -> None:
    """Refuse what is no state, and a state of skin without a face.

    Raises:
        InputError: For either.
    """
    if state is None:
        return
    if not isinstance(state, BloodState):
        raise InputError(
            "state is a change of blood, such as DynamicModel.load().change({'flush': 0.7}) of "
            f"skinnet.appearance; got {state!r:.60}."
        )
    if region == "skin":
        raise InputError(
            "A state of blood is laid out by the landmarks of a face, and the region skin has "
            "none; leave out one of them."
        )


def place_state(
    state: BloodState,
    outputs: Mapping[str, NDArray[np.float32]],
    landmarks: NDArray[np.floating],
    box: Box,
    most: float,
) -> NDArray[np.float32]:
    """Hemoglobin [1, h, w] in a state, from the encoder's outputs for a box around a face.

    Args:
        state: The state.
        outputs: Maps [1, h, w] of the box.
        landmarks: Columns and rows of the face's landmarks in the photograph, [478, 2].
        box: The part of the photograph that was read.
        most: The largest volume fraction.
    """
    blood, skin = outputs["hemoglobin"][0], outputs["mask"][0]
    scale = np.array([blood.shape[1] / box.width, blood.shape[0] / box.height])
    return state(blood, (landmarks - (box.left, box.top)) * scale, skin, most)[None]
