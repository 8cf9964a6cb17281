"""Sampling of pictures between their pixels."""

import numpy as np
from jaxtyping import Float, Shaped
from scipy.ndimage import map_coordinates


def sample_bilinear(
    picture: Shaped[np.ndarray, "height width channels"], uv: Float[np.ndarray, "points 2"]
) -> Float[np.ndarray, "points channels"]:
    """Sample a picture at texture coordinates by bilinear interpolation.

    Beyond the centres of the outermost pixels their values continue.

    Args:
        picture: Any number of channels, row 0 at the top.
        uv: Texture coordinates with the origin at the lower left; pixel (r, c) of a picture of
            H x W has its centre at ((c + .5) / W, 1 - (r + .5) / H).

    Returns:
        Values in the picture's own scale, float32.

    Example:
        >>> import numpy as np
        >>> from skinnet.mesh._sampling import sample_bilinear
        >>> picture = np.array([[[0], [10]]], np.uint8)
        >>> sample_bilinear(picture, np.array([[0.25, 0.5], [0.5, 0.5], [1.0, 0.5]])).ravel()
        array([ 0.,  5., 10.], dtype=float32)
    """
    height, width, channels = picture.shape
    place = np.stack([(1 - uv[:, 1]) * height - 0.5, uv[:, 0] * width - 0.5])
    sampled = np.empty((len(uv), channels), np.float32)
    for channel in range(channels):
        sampled[:, channel] = map_coordinates(
            picture[..., channel], place, np.float32, order=1, mode="nearest"
        )
    return sampled
