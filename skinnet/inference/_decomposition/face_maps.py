"""Where the parts of the face are in the maps."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from skinnet.errors import InputError
from skinnet.images.faces._face_regions import REGION_NAMES
from skinnet.images.faces._outlines import Patch
from skinnet.inference._decomposition.maps import SKIN_THRESHOLD, SkinMaps


@dataclass(frozen=True, eq=False, repr=False)
class FaceMaps(SkinMaps):
    """Maps of which masks of the parts of the face can be made."""

    @property
    def landmarks(self) -> NDArray[np.float32] | None:
        """Columns and rows of the 478 points of MediaPipe's face mesh, float32 [478, 2].

        They are in pixels from the photograph's upper left corner, so that the centre of its first
        pixel is (0.5, 0.5). The last ten are the irises. None if no face was looked for.
        """
        return None if self.face_parts is None else self.face_parts.landmarks

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
        if not isinstance(name, str) or name not in REGION_NAMES:
            names = ", ".join(REGION_NAMES)
            raise InputError(f"The regions of a face are {names}; got {name!r:.60}.")
        if self.face_parts is None:
            raise InputError(f"No face was looked for, so there is no {name}; leave out region.")
        patch = self.face_parts.regions[name].patch
        skin = self.mask[patch.box.slices] > SKIN_THRESHOLD
        return self._paste([Patch(patch.box, patch.inside & skin)])

    def _paste(self, patches: Sequence[Patch]) -> NDArray[np.bool_]:
        """A mask of the photograph's size."""
        mask = np.zeros(self.mask.shape, bool)
        for patch in patches:
            mask[patch.box.slices] |= patch.inside
        return mask
