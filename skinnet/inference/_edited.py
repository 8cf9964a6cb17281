"""An edited picture, and what has changed in it."""

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from skinnet.images.box import Box
from skinnet.images.picture import Picture
from skinnet.images.srgb import linear_to_srgb
from skinnet.inference._editing import ColourMeans

_DECIMALS = 1


class EditedFace(NamedTuple):
    """What has changed of one face, or of bare skin.

    Attributes:
        face_id: Number of the face, from 1, from left to right among all faces of the photograph;
            None if no face was looked for.
        box: The part of the photograph that was edited.
        means: Mean colours of the skin before and after.
    """

    face_id: int | None
    box: Box
    means: ColourMeans

    def describe(self, name: str) -> str:
        """Say in a sentence what has changed in a photograph of a name."""
        who = f"face {self.face_id} in {name}" if self.face_id else f"the skin in {name}"
        before, after = (
            ",".join(f"{level:.0f}" for level in _to_levels(each) or ())
            for each in (self.means.before, self.means.after)
        )
        if not before:
            return f"No pixel of {who} is edited."
        return (
            f"{self.means.weight:,.0f} pixels of {who} are edited; their mean colour in sRGB "
            f"is {before} before and {after} after."
        )

    def to_json(self) -> dict[str, Any]:
        """Return it for JSON: colours as sRGB from 0 to 255, null where no skin was edited."""
        colours = {"before": self.means.before, "after": self.means.after}
        return {
            "id": self.face_id,
            "box": self.box._asdict(),
            "edited_pixels": round(self.means.weight),
            "colour": {name: _to_levels(colour) for name, colour in colours.items()},
        }


class Edited(NamedTuple):
    """An edited picture.

    Attributes:
        picture: The picture, with notes on it.
        faces: What has changed of each face that was edited.
        faces_found: Number of faces in the photograph; None if none was looked for.
    """

    picture: Picture
    faces: tuple[EditedFace, ...]
    faces_found: int | None


def _to_levels(linear: NDArray[np.float64]) -> list[float] | None:
    """Levels of sRGB from 0 to 255, not rounded to whole ones."""
    if math.isnan(linear[0]):
        return None
    levels = 255 * linear_to_srgb(linear.astype(np.float32))
    return [round(float(level), _DECIMALS) for level in levels]
