"""Values of a picture between its pixels."""

import numpy as np
from jaxtyping import Float, Shaped


def sample_bilinear(
    picture: Shaped[np.ndarray, "height width channels"], uv: Float[np.ndarray, "points 2"]
) -> Float[np.ndarray, "points channels"]:
    """Values at texture coordinates, float32, in the picture's own scale.

    The origin of `uv` is the lower left of the picture, whose row 0 is the top; pixel (r, c) has
    its centre at ((c + .5) / W, 1 - (r + .5) / H). Beyond the outermost centres their values go on.
    """
    height, width, channels = picture.shape
    left, along = _cell(uv[:, 0] * width - 0.5, width)
    top, down = _cell((1 - uv[:, 1]) * height - 0.5, height)
    flat = picture.reshape(-1, channels)
    here = top * width + left
    # A picture of one row or column has no next one.
    right, below = int(width > 1), width * int(height > 1)
    upper = _mix(flat, here, here + right, along)
    lower = _mix(flat, here + below, here + below + right, along)
    return np.asarray(upper + (lower - upper) * down)


def _cell(
    place: Float[np.ndarray, "points"], count: int
) -> tuple[Shaped[np.ndarray, "points"], Float[np.ndarray, "points 1"]]:
    place = place.clip(0, count - 1)
    first = place.astype(np.int64).clip(0, max(count - 2, 0))
    return first, (place - first).astype(np.float32)[:, None]


def _mix(
    flat: Shaped[np.ndarray, "pixels channels"],
    first: Shaped[np.ndarray, "points"],
    second: Shaped[np.ndarray, "points"],
    share: Float[np.ndarray, "points 1"],
) -> Float[np.ndarray, "points channels"]:
    start = flat[first].astype(np.float32)
    return np.asarray(start + (flat[second].astype(np.float32) - start) * share)
