"""A chart of the face: the place of each pixel on a mesh of landmarks that all faces share.

Beyond the mesh, a rim continues it over ears, hairline and throat.
"""

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage
from scipy.interpolate import LinearNDInterpolator

from skinnet.images.faces._face_mesh import MESH_POINTS
from skinnet.images.faces._face_place import place_face
from skinnet.images.faces._face_zones import _OVAL

_RIM = 1.75
"""Distance of the rim from the middle of the face, in distances of the face's outline."""

_SIDE = 1.9
"""Side of a chart in sides of the face's box, so that the rim lies about at its edges."""

_SOLID = 1.6
"""The rim's influence ends this many times nearer to the outline than the rim is, so that ears are
within."""

_EXTENDED = MESH_POINTS + len(_OVAL)

Points = NDArray[np.floating]


def extend_landmarks(landmarks: Points) -> NDArray[np.float64]:
    """Landmarks of the mesh [468, 2] and the rim around them [36, 2], from the 478 of a face."""
    mesh = landmarks[:MESH_POINTS].astype(np.float64)
    outline = mesh[list(_OVAL)]
    middle = outline.mean(0)
    return np.concatenate([mesh, middle + _RIM * (outline - middle)])


def normalise_landmarks(landmarks: Points) -> NDArray[np.float64]:
    """Turn the landmarks [478, 2] of a face upright, into a chart from 0 to 1."""
    square = place_face(landmarks.astype(np.float32))
    matrix = square._replace(side=_SIDE * square.side).matrix(1)
    turned: NDArray[np.float64] = (landmarks - matrix[:, 2]) @ np.linalg.inv(matrix[:, :2]).T
    return turned


def locate_on_chart(
    landmarks: Points, chart: Points, shape: tuple[int, ...]
) -> tuple[NDArray[np.float64], NDArray[np.float32]]:
    """Find the place on a chart of each pixel of a picture.

    Args:
        landmarks: Columns and rows of the face's landmarks in pixels of the picture, [478, 2].
        chart: The places of the same landmarks on the chart, from 0 to 1, [478, 2].
        shape: Rows and columns of the picture.

    Returns:
        Places from 0 to 1, right and down, [h, w, 2], and weights [h, w] that fall smoothly from 1
        at the face's outline and the ears to 0 at the rim.
    """
    values = np.column_stack([extend_landmarks(chart), np.arange(_EXTENDED) < MESH_POINTS])
    find = LinearNDInterpolator(extend_landmarks(landmarks), values, fill_value=0.0)
    columns, rows = np.meshgrid(np.arange(shape[1]) + 0.5, np.arange(shape[0]) + 0.5)
    found: NDArray[np.float64] = find(columns, rows)
    near = np.clip(_SOLID * found[..., 2], 0, 1)
    return found[..., :2], (near**2 * (3 - 2 * near)).astype(np.float32)


def place_texels(landmarks: Points, chart: Points, size: int) -> NDArray[np.float64]:
    """Find the columns and rows [size, size, 2] in a picture of a chart's texels; NaN outside.

    Args:
        landmarks: Columns and rows of the face's landmarks in pixels of the picture, [478, 2].
        chart: The places of the same landmarks on the chart, from 0 to 1, [478, 2].
        size: Side of the chart in texels.
    """
    place = LinearNDInterpolator(extend_landmarks(chart), extend_landmarks(landmarks))
    line = (np.arange(size) + 0.5) / size
    return np.asarray(place(*np.meshgrid(line, line)))


def warp_to_chart(
    values: NDArray[np.floating], landmarks: Points, chart: Points, size: int
) -> NDArray[np.float32]:
    """Lay a map [h, w] of a picture out on a chart [size, size], as of `place_texels`.

    Texels outside the picture, or beside pixels that are NaN, are NaN.
    """
    at = np.moveaxis(place_texels(landmarks, chart, size)[..., ::-1], -1, 0) - 0.5
    inside = np.isfinite(at).all(0)
    sampled = ndimage.map_coordinates(
        values, np.where(inside, at, 0), order=1, cval=np.nan, output=np.float32
    )
    return np.where(inside, sampled, np.float32(np.nan))
