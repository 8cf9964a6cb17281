"""A model's texture space, and the piecewise affine warp of pictures into it."""

from functools import cached_property
from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float, Int, Shaped

from skinnet.errors import InputError
from skinnet.mesh._barycentric import compute_barycentric_gradients
from skinnet.mesh._sampling import sample_bilinear
from skinnet.mesh.raster import rasterise

MAX_SAMPLES = 8
"""Largest number of samples along a texel's side; a denser picture is subsampled."""

SINGLE_SAMPLE_LIMIT = 1.5
"""Largest number of picture pixels along a texel for which one sample is enough."""


class WarpedTexture(NamedTuple):
    """A picture in a texture space.

    Attributes:
        image: Values as float32, 0 where `mask` is False.
        mask: True where the picture covers the texel.
    """

    image: Float[np.ndarray, "size size channels"]
    mask: Bool[np.ndarray, "size size"]


class TextureSpace:
    """The texels of a square texture, each with its triangle and its position in it.

    The texel of row r and column c has its centre at u = (c + .5) / size, v = 1 - (r + .5) / size.

    Args:
        uv: Texture coordinates in [0, 1].
        triangles: Texture coordinates of each triangle's corners.
        size: Texels along a side.

    Attributes:
        triangle: Triangle of each texel, -1 outside.
        barycentric: Barycentric coordinates of each texel, 0 outside.
        mask: True for the texels inside a triangle.

    Raises:
        InputError: If a corner is out of range, or `size` is below 1.

    Source:
        Section 4.2 of Alotaibi & Smith 2017.

    Example:
        >>> import numpy as np
        >>> from skinnet.texture import TextureSpace
        >>> corners = np.array([[0.0, 0], [1, 0], [0, 1]])
        >>> space = TextureSpace(corners, np.array([[0, 1, 2]]), 2)
        >>> space.interpolate(np.array([[0.0], [4.0], [8.0]]))[..., 0]
        array([[7., 0.],
               [3., 5.]])
    """

    def __init__(
        self,
        uv: Float[np.ndarray, "points 2"],
        triangles: Int[np.ndarray, "triangles 3"],
        size: int,
    ) -> None:
        if triangles.size == 0 or triangles.min() < 0 or triangles.max() >= len(uv):
            raise InputError(
                f"A texture space needs triangles with corners from 0 to {len(uv) - 1}, the "
                "indices of its texture coordinates."
            )
        if size < 1:
            raise InputError(f"A texture space has at least one texel a side; got {size}.")
        self.uv, self.triangles, self.size = uv, triangles, size
        self.triangle, self.barycentric = rasterise(uv[triangles], size)
        self.mask = self.triangle >= 0

    @cached_property
    def texel_triangles(self) -> Int[np.ndarray, "texels"]:
        """Triangle of each texel inside, in the order of `mask`."""
        return self.triangle[self.mask]

    @cached_property
    def texel_weights(self) -> Float[np.ndarray, "texels 3"]:
        """Barycentric coordinates of each texel inside, in the order of `mask`."""
        return self.barycentric[self.mask]

    def interpolate(
        self, values: Float[np.ndarray, "points k"] | Float[np.ndarray, "triangles 3 k"]
    ) -> Float[np.ndarray, "size size k"]:
        """Interpolate values at every texel.

        Args:
            values: Values at the texture coordinates, or at each triangle's corners.

        Returns:
            The interpolated values, 0 outside the triangles.
        """
        corners = values[self.triangles] if values.ndim == 2 else values
        image = np.zeros((self.size, self.size, values.shape[-1]), values.dtype)
        image[self.mask] = self.interpolate_texels(corners, slice(None))
        return image

    def interpolate_texels(
        self,
        corners: Float[np.ndarray, "triangles 3 k"],
        chosen: Shaped[np.ndarray, "_"] | slice,
    ) -> Float[np.ndarray, "chosen k"]:
        """Interpolate values at some of the texels inside.

        Args:
            corners: Values at each triangle's corners.
            chosen: Indices into the texels inside, in the order of `mask`, or a slice of them.

        Returns:
            The interpolated values.
        """
        owner, weights = self.texel_triangles[chosen], self.texel_weights[chosen]
        total = weights[:, :1] * corners[owner, 0]
        for k in (1, 2):
            total += weights[:, k, None] * corners[owner, k]
        return np.asarray(total)


def warp_texture(
    space: TextureSpace,
    coordinates: Float[np.ndarray, "triangles 3 2"],
    covered: Bool[np.ndarray, "triangles"],
    texture: Shaped[np.ndarray, "height width channels"],
    max_samples: int = MAX_SAMPLES,
) -> WarpedTexture:
    """Warp a picture into a texture space, affinely in every triangle.

    Where the picture is denser than the texture, a texel is the mean of k x k samples over its
    footprint, where k is the number of pixels along the footprint's longer side. The paper takes
    one sample. scikit-image's piecewise affine warp gives the same result and takes about 6 times
    as long for 100 points at 256 x 256 (`python -m benchmarks.texture`).

    Args:
        space: The texture space.
        coordinates: Texture coordinates of the triangles' corners in the picture.
        covered: True for the triangles that the picture covers; texels of others are masked.
        texture: The picture. Values are interpolated as they are, so it should be linear.
        max_samples: Upper limit of k; 1 for the paper's warp.

    Returns:
        The warped picture and its mask.

    Source:
        Section 4.2 of Alotaibi & Smith 2017.

    Example:
        >>> import numpy as np
        >>> from skinnet.texture import TextureSpace, warp_texture
        >>> corners, triangle = np.array([[0.0, 0], [1, 0], [0, 1]]), np.array([[0, 1, 2]])
        >>> space = TextureSpace(corners, triangle, 2)
        >>> picture = np.arange(4.0).reshape(2, 2, 1)
        >>> warp_texture(space, corners[triangle], np.array([True]), picture).image[..., 0]
        array([[0., 0.],
               [2., 3.]], dtype=float32)
    """
    chosen = np.flatnonzero(covered[space.texel_triangles])
    jacobian = _compute_jacobian(space, coordinates)
    samples = _count_samples(jacobian, texture.shape[:2]).clip(max=max_samples)[
        space.texel_triangles[chosen]
    ]
    values = np.empty((len(chosen), texture.shape[2]), np.float32)
    for count in np.unique(samples):
        group = samples == count
        texels = chosen[group]
        centres = space.interpolate_texels(coordinates, texels)
        values[group] = _average(
            texture, centres, jacobian, space.texel_triangles[texels], int(count)
        )
    image = np.zeros((space.size, space.size, texture.shape[2]), np.float32)
    mask = np.zeros_like(space.mask)
    mask[space.mask] = covered[space.texel_triangles]
    image[mask] = values
    return WarpedTexture(image, mask)


def _compute_jacobian(
    space: TextureSpace, coordinates: Float[np.ndarray, "triangles 3 2"]
) -> Float[np.ndarray, "triangles 2 2"]:
    """Compute the change of the picture's u and v (last axis) per texel along columns and rows."""
    change = compute_barycentric_gradients(space.uv[space.triangles] * [1, -1]) / space.size
    return np.asarray(np.nan_to_num(np.einsum("tkd,tkx->tdx", change, coordinates)))


def _count_samples(
    jacobian: Float[np.ndarray, "triangles 2 2"], shape: tuple[int, ...]
) -> Int[np.ndarray, "triangles"]:
    """Count the samples along a texel's side in each triangle."""
    pixels = np.sqrt(((jacobian * [shape[1], shape[0]]) ** 2).sum(-1)).max(-1)
    return np.asarray(np.ceil(pixels - SINGLE_SAMPLE_LIMIT + 1).clip(1), np.int64)


def _average(
    texture: Shaped[np.ndarray, "height width channels"],
    centres: Float[np.ndarray, "texels 2"],
    jacobian: Float[np.ndarray, "triangles 2 2"],
    owner: Int[np.ndarray, "texels"],
    count: int,
) -> Float[np.ndarray, "texels channels"]:
    if count == 1:
        return sample_bilinear(texture, centres)
    steps = (np.arange(count) + 0.5) / count - 0.5
    along, down = jacobian[owner, 0], jacobian[owner, 1]
    total = np.zeros((len(centres), texture.shape[2]), np.float32)
    for x in steps:
        for y in steps:
            total += sample_bilinear(texture, centres + x * along + y * down)
    return total / count**2
