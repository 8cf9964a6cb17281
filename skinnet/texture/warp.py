"""A model's texture space, and pictures warped into it."""

from functools import cached_property
from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float, Int, Shaped

from skinnet.errors import InputError
from skinnet.mesh._barycentric import barycentric_gradients
from skinnet.mesh.raster import rasterise
from skinnet.mesh.sampling import sample_bilinear

MOST_SAMPLES = 8
"""Samples along a texel, at most; a source still denser than that is not wholly averaged."""

DENSE = 1.5
"""Source pixels along a texel from which more than one sample is taken."""


class WarpedTexture(NamedTuple):
    """A picture in a texture space, float32, 0 where `mask` is False and nothing is known."""

    image: Float[np.ndarray, "size size channels"]
    mask: Bool[np.ndarray, "size size"]


class TextureSpace:
    """The texels of a map of `size` x `size`: which triangle each lies in, and where in it.

    Made once for a model. `uv` [U, 2] in [0, 1], `triangles` [T, 3] into it. `triangle` [n, n] is
    -1 and `barycentric` [n, n, 3] 0 outside the triangles, `mask` [n, n] is True inside. Texel
    (row r, column c) has its centre at u = (c + .5) / n, v = 1 - (r + .5) / n.
    """

    def __init__(
        self,
        uv: Float[np.ndarray, "points 2"],
        triangles: Int[np.ndarray, "triangles 3"],
        size: int,
    ):
        if triangles.size == 0 or triangles.min() < 0 or triangles.max() >= len(uv):
            raise InputError(
                f"A texture space needs triangles with corners from 0 to {len(uv) - 1}, the "
                "texture coordinates that there are."
            )
        if size < 1:
            raise InputError(f"A texture space has at least one texel a side; got {size}.")
        self.uv, self.triangles, self.size = uv, triangles, size
        self.triangle, self.barycentric = rasterise(uv[triangles], size)
        self.mask = self.triangle >= 0

    @cached_property
    def owner(self) -> Int[np.ndarray, "texels"]:
        """Triangle of each texel inside, in the order of `mask`."""
        return self.triangle[self.mask]

    @cached_property
    def weights(self) -> Float[np.ndarray, "texels 3"]:
        """Barycentric coordinates of each texel inside, in the order of `mask`."""
        return self.barycentric[self.mask]

    def interpolate(
        self, values: Float[np.ndarray, "points k"] | Float[np.ndarray, "triangles 3 k"]
    ) -> Float[np.ndarray, "size size k"]:
        """Values [U, k] of the texture's points, or [T, 3, k] of the triangles' corners, at every
        texel; 0 outside the triangles."""
        corners = values[self.triangles] if values.ndim == 2 else values
        image = np.zeros((self.size, self.size, values.shape[-1]), values.dtype)
        image[self.mask] = self.at(corners, slice(None))
        return image

    def at(
        self,
        corners: Float[np.ndarray, "triangles 3 k"],
        chosen: Shaped[np.ndarray, "_"] | slice,
    ) -> Float[np.ndarray, "chosen k"]:
        """Values [T, 3, k] of the triangles' corners at some of the texels inside."""
        owner, weights = self.owner[chosen], self.weights[chosen]
        total = weights[:, :1] * corners[owner, 0]
        for k in (1, 2):
            total += weights[:, k, None] * corners[owner, k]
        return np.asarray(total)


def warp_texture(
    space: TextureSpace,
    coordinates: Float[np.ndarray, "triangles 3 2"],
    covered: Bool[np.ndarray, "triangles"],
    texture: Shaped[np.ndarray, "height width channels"],
    most_samples: int = MOST_SAMPLES,
) -> WarpedTexture:
    """A picture warped into a texture space, affinely in every triangle (paper 4.2).

    `coordinates` are those of the triangles' corners in the picture, whose values are interpolated
    between pixels as they are: hand in linear ones. Triangles that are not `covered` stay masked.
    Where the picture is denser than the map, a texel is the mean of k x k samples spread over its
    footprint, k being the pixels along the footprint's longer side, at most `most_samples`; 1 is
    the paper's.
    """
    chosen = np.flatnonzero(covered[space.owner])
    jacobian = _jacobian(space, coordinates)
    samples = _samples(jacobian, texture.shape[:2]).clip(max=most_samples)[space.owner[chosen]]
    values = np.empty((len(chosen), texture.shape[2]), np.float32)
    for count in np.unique(samples):
        group = samples == count
        texels = chosen[group]
        centres = space.at(coordinates, texels)
        values[group] = _average(texture, centres, jacobian, space.owner[texels], int(count))
    image = np.zeros((space.size, space.size, texture.shape[2]), np.float32)
    mask = np.zeros_like(space.mask)
    mask[space.mask] = covered[space.owner]
    image[mask] = values
    return WarpedTexture(image, mask)


def _jacobian(
    space: TextureSpace, coordinates: Float[np.ndarray, "triangles 3 2"]
) -> Float[np.ndarray, "triangles 2 2"]:
    """Change of the source's u and v (last axis) over one texel along columns and rows."""
    change = barycentric_gradients(space.uv[space.triangles] * [1, -1]) / space.size
    return np.asarray(np.nan_to_num(np.einsum("tkd,tkx->tdx", change, coordinates)))


def _samples(
    jacobian: Float[np.ndarray, "triangles 2 2"], shape: tuple[int, ...]
) -> Int[np.ndarray, "triangles"]:
    """Samples a side of a texel in each triangle."""
    pixels = np.sqrt(((jacobian * [shape[1], shape[0]]) ** 2).sum(-1)).max(-1)
    return np.asarray(np.ceil(pixels - DENSE + 1).clip(1), np.int64)


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
