"""The texture space of a face in a video: a mesh of its landmarks at rest."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import Delaunay

from skinnet.images.faces._face_mesh import MESH_POINTS
from skinnet.images.faces._face_place import place_face
from skinnet.images.faces._turned_square import TurnedSquare
from skinnet.video._regions import mark_regions

SIZE = 96
"""Side of the texture, in texels."""

_MARGIN = 1.28
"""Side of the texture in sides of the face's box, so that the whole mesh lies in it."""

Points = NDArray[np.floating]


class TextureSpace(NamedTuple):
    """A square of texels, each at a fixed place in a triangle of landmarks.

    Attributes:
        landmarks: Where the landmarks lie in it, in texels, [478, 2].
        inside: Which texels the mesh covers, bool [size, size].
        corners: Landmarks at the corners of each covered texel's triangle, [texels, 3].
        weights: Barycentric coordinates of each covered texel, [texels, 3].
        regions: Masks of the regions, [regions, size, size].
    """

    landmarks: Points
    inside: NDArray[np.bool_]
    corners: NDArray[np.intp]
    weights: NDArray[np.float32]
    regions: NDArray[np.bool_]

    @classmethod
    def from_landmarks(cls, landmarks: Points) -> "TextureSpace":
        """Make the texture space of a face at rest from its landmarks in a picture, [478, 2]."""
        square = place_face(landmarks.astype(np.float32))
        at_rest = _to_texels(square._replace(side=_MARGIN * square.side), landmarks)
        mesh = Delaunay(at_rest[:MESH_POINTS])
        centres = np.stack(np.meshgrid(*[np.arange(SIZE) + 0.5] * 2), -1).reshape(-1, 2)
        found = mesh.find_simplex(centres)
        inside = found >= 0
        triangle = found[inside]
        transform = mesh.transform[triangle]
        two = np.einsum("nij,nj->ni", transform[:, :2], centres[inside] - transform[:, 2])
        weights = np.column_stack([two, 1 - two.sum(1)]).astype(np.float32)
        shape = inside.reshape(SIZE, SIZE)
        regions = mark_regions(at_rest, SIZE) & shape
        return cls(at_rest, shape, mesh.simplices[triangle].astype(np.intp), weights, regions)

    def place(self, landmarks: Points) -> NDArray[np.float32]:
        """Columns and rows [texels, 2] of the covered texels in a picture with these landmarks."""
        corners = landmarks.astype(np.float32)[self.corners]
        placed: NDArray[np.float32] = np.einsum("nk,nkd->nd", self.weights, corners)
        return placed

    def fill(self, values: NDArray[np.floating], blank: float = np.nan) -> NDArray[np.float32]:
        """Lay values of the covered texels [texels, ...] out as a texture [size, size, ...]."""
        texture = np.full((SIZE, SIZE, *values.shape[1:]), blank, np.float32)
        texture[self.inside] = values
        return texture


def measure_texel(landmarks: Points) -> float:
    """Side of a texel in pixels of a picture with these landmarks."""
    return _MARGIN * place_face(landmarks.astype(np.float32)).side / SIZE


def sample(image: NDArray[np.float32], points: NDArray[np.float32]) -> NDArray[np.float32]:
    """Sample an image [H, W, channels] bilinearly at columns and rows [N, 2] of pixels' corners."""
    height, width = image.shape[:2]
    x = np.clip(points[:, 0] - 0.5, 0, width - 1.001)
    y = np.clip(points[:, 1] - 0.5, 0, height - 1.001)
    column, row = x.astype(np.int32), y.astype(np.int32)
    right, down = (
        (place - whole).astype(np.float32)[:, None] for place, whole in ((x, column), (y, row))
    )
    flat, first = image.reshape(height * width, -1), row * width + column
    below = np.minimum(first + width, height * width - 1)
    after = np.minimum(below + 1, height * width - 1)
    top = flat[first] * (1 - right) + flat[np.minimum(first + 1, height * width - 1)] * right
    bottom = flat[below] * (1 - right) + flat[after] * right
    return np.asarray(top * (1 - down) + bottom * down, np.float32)


def _to_texels(square: TurnedSquare, points: Points) -> Points:
    matrix = square.matrix(SIZE)
    return np.asarray((points - matrix[:, 2]) @ np.linalg.inv(matrix[:, :2]).T)
