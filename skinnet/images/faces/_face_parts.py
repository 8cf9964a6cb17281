"""The parts of a face in a photograph: its landmarks, regions, sclera and teeth."""

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from skinnet.images.faces._eyes import locate_sclera
from skinnet.images.faces._face_regions import REGION_NAMES, locate_region
from skinnet.images.faces._outlines import Patch
from skinnet.images.faces._skin_reference import Colours, measure_colours, measure_skin
from skinnet.images.faces._teeth import locate_teeth
from skinnet.images.faces.face import Face

_REFERENCE = ("forehead", "left_cheek", "right_cheek", "nose")
"""Regions whose median colour is taken for that of the skin; beards leave them free."""

_BEARDED = ("chin", "neck")

_BEARD = 0.24
"""Difference of log R/G from the skin from which on chin and neck are taken for a grey beard. It
takes a third or more from 17 of 952 chins in portraits; 11 of them have a beard."""

_BEARD_DETAIL = 0.1
"""Size of the neighbourhood over which that is averaged, in sides of the region's box."""


class FaceRegion(NamedTuple):
    """A region of a face.

    Attributes:
        patch: Its pixels inside the photograph, without a grey beard.
        area: Number of its pixels, with those outside the photograph and those of a beard.
    """

    patch: Patch
    area: int


class FaceParts(NamedTuple):
    """The parts of a face.

    Attributes:
        landmarks: Points of the face mesh, float32 [478, 2], in pixels of the photograph.
        regions: The regions by name.
        sclera: The sclera of each eye.
        teeth: The teeth.
    """

    landmarks: NDArray[np.float32]
    regions: Mapping[str, FaceRegion]
    sclera: Sequence[Patch]
    teeth: Sequence[Patch]


def find_face_parts(photo: NDArray[np.uint8], face: Face) -> FaceParts:
    """Find the parts of a face in a photograph, uint8 sRGB [H, W, 3]."""
    landmarks = face.landmarks
    regions = {name: _clip_region(landmarks, name, photo.shape) for name in REGION_NAMES}
    skin = measure_skin(photo, (regions[name].patch for name in _REFERENCE))
    if skin is None:
        return FaceParts(landmarks, regions, (), ())
    for name in _BEARDED:
        regions[name] = _leave_out_beard(photo, regions[name], skin)
    sclera, teeth = (locate(photo, landmarks, skin) for locate in (locate_sclera, locate_teeth))
    return FaceParts(landmarks, regions, tuple(sclera), tuple(teeth))


def _clip_region(landmarks: NDArray[np.float32], name: str, shape: tuple[int, ...]) -> FaceRegion:
    whole = locate_region(landmarks, name)
    return FaceRegion(whole.clip(shape[0], shape[1]), int(whole.inside.sum()))


def _leave_out_beard(photo: NDArray[np.uint8], region: FaceRegion, skin: Colours) -> FaceRegion:
    box, inside = region.patch
    red = measure_colours(photo[box.slices]).red
    size = 1 + round(_BEARD_DETAIL * min(box.width, box.height))
    is_bare = ndimage.uniform_filter(red, size) > skin.red - _BEARD
    return region._replace(patch=Patch(box, inside & is_bare))
