"""Face parts as plain types and arrays, and back."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from skinnet.images.box import Box
from skinnet.images.faces._face_parts import FaceParts, FaceRegion
from skinnet.images.faces._outlines import Patch
from skinnet.inference._decomposition.array_file import ArrayFile

_LANDMARKS, _PATCHES = "landmarks", "patches"


def record_parts(parts: FaceParts | None, arrays: dict[str, NDArray[Any]]) -> Any:
    """Make a record of face parts, and add their arrays; None without a face.

    All patches are in one array, in the order of the record.
    """
    if parts is None:
        return None
    patches = [
        *(region.patch for region in parts.regions.values()),
        *parts.sclera,
        *parts.teeth,
    ]
    arrays[_LANDMARKS] = parts.landmarks
    arrays[_PATCHES] = np.concatenate([each.inside.ravel() for each in patches])
    return {
        "regions": {
            name: {"box": list(region.patch.box), "area": region.area}
            for name, region in parts.regions.items()
        },
        "sclera": [list(patch.box) for patch in parts.sclera],
        "teeth": [list(patch.box) for patch in parts.teeth],
    }


def restore_parts(record: Any, file: ArrayFile, shape: tuple[int, int]) -> FaceParts | None:
    """Restore what `record_parts` has recorded, of a photograph of a shape.

    Raises:
        ValueError: A patch is outside the photograph, or they are not as large as their array.
    """
    if record is None:
        return None
    pixels = _Pixels(file.read(_PATCHES, (None,), "bool"), shape)
    regions = {
        str(name): FaceRegion(pixels.take(one["box"]), int(one["area"]))
        for name, one in record["regions"].items()
    }
    sclera, teeth = (
        tuple(pixels.take(box) for box in record[name]) for name in ("sclera", "teeth")
    )
    pixels.finish()
    return FaceParts(file.read(_LANDMARKS, (478, 2), "float32"), regions, sclera, teeth)


def restore_box(sides: Sequence[int] | Mapping[str, int], shape: tuple[int, int]) -> Box:
    """Restore a box within a photograph of a shape.

    Raises:
        ValueError: It is not within the photograph.
    """
    box = Box(*(int(side) for side in sides))
    height, width = shape
    if not (0 <= box.left <= box.right <= width and 0 <= box.top <= box.bottom <= height):
        raise ValueError(f"{box} is not in a photograph of {width} x {height} pixels")
    return box


class _Pixels:
    """The pixels of all patches, one after the other."""

    def __init__(self, values: NDArray[np.bool_], shape: tuple[int, int]) -> None:
        self._values, self._shape = values, shape

    def take(self, sides: Sequence[int]) -> Patch:
        """Take the patch of a box."""
        box = restore_box(sides, self._shape)
        count = box.width * box.height
        taken, self._values = self._values[:count], self._values[count:]
        return Patch(box, taken.reshape(box.height, box.width).copy())

    def finish(self) -> None:
        """Raise `ValueError` if some are left."""
        if self._values.size:
            raise ValueError(f"{self._values.size} pixels of parts of the face have no box")
