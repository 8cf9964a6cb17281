"""The texture space of a shape model (section 4.2 of Alotaibi & Smith 2017)."""

import math
from dataclasses import dataclass, replace

import numpy as np

from skinnet.errors import InputError
from skinnet.shape.model import ShapeModel
from skinnet.texture._mirror import find_mirror_vertices
from skinnet.texture.projection import MAX_NORMAL_ANGLE
from skinnet.texture.tutte import compute_tutte_embedding


@dataclass(frozen=True)
class WarpSettings:
    """Settings of the warp of a scan's texture into the model's texture space (section 4.2).

    Args:
        size: Texels along a side of the maps.
        limit: Distance in mm between model and scan above which a texel is not covered.
        angle: Angle in degrees between their normals above which it is not covered.
        own_uv: Use the model's own texture coordinates instead of a Tutte embedding of its mean.

    Raises:
        InputError: If the size is out of range.

    Source:
        Section 4.2 of Alotaibi & Smith 2017, who use 1024 texels.

    Example:
        >>> WarpSettings(size=4)
        Traceback (most recent call last):
        ...
        skinnet.errors.InputError: size is a number of texels from 16 to 8192; got 4.
    """

    size: int = 1024
    limit: float = 5.0
    angle: float = MAX_NORMAL_ANGLE
    own_uv: bool = False

    def __post_init__(self) -> None:
        if not 16 <= self.size <= 8192:
            raise InputError(f"size is a number of texels from 16 to 8192; got {self.size}.")
        if not 0 < self.limit < math.inf:
            raise InputError(f"limit is a distance in mm above 0; got {self.limit}.")
        if not 0 < self.angle <= 180:
            raise InputError(f"angle is in (0, 180] degrees; got {self.angle}.")


def embed_model(model: ShapeModel, own_uv: bool = False) -> ShapeModel:
    """Give a shape model the texture space in which maps are made.

    Args:
        model: The shape model.
        own_uv: Keep the model's own texture coordinates.

    Returns:
        The model with a Tutte embedding of its mean shape as texture coordinates, or with its own.

    Raises:
        InputError: If the model's own texture coordinates are asked for and there are none.

    Source:
        Section 4.2 of Alotaibi & Smith 2017.

    Example:
        >>> from skinnet.shape import load_shape_model
        >>> model = load_shape_model()
        >>> embed_model(model, own_uv=True) is model
        True
    """
    if own_uv:
        if model.uv is None:
            raise InputError(f"{model.name} has no texture coordinates; leave out own_uv.")
        return model
    mean = model.mean.astype(np.float64)
    uv = compute_tutte_embedding(mean, model.triangles, find_mirror_vertices(mean))
    return replace(model, uv=uv, uv_triangles=model.triangles)
