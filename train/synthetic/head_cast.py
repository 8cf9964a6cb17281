"""What a camera sees of a synthetic head, without any light."""

from typing import NamedTuple

import numpy as np
from jaxtyping import Float, Float16, Int8, UInt8, UInt64

from skinnet.mesh import Mesh
from skinnet.render import GeometryBuffers, OrthographicView, PerspectiveView, Scene, trace_geometry
from train.synthetic.directions import DIRECTIONS
from train.synthetic.heads import Head

ANGLES, FARTHEST = (0.12, 0.35, 0.10), 0.6
"""Standard deviations of pitch, yaw and roll, and their largest, in radians."""

FAR = 20.0


class Buffers(NamedTuple):
    """The surface under each pixel, or of a stack of pictures with one axis more.

    `label` is of `train.synthetic.labels`; `normal` is in the camera's axes (right, up, towards it)
    times 127; `chart` the place on the label's paint; `openness` the share of the cosine-weighted
    sky that nothing hides, times 255. Bit k of `seen` is set where nothing stands between the
    surface and `DIRECTIONS[k]`; it is not set where the surface looks away. The background's are
    all set.
    """

    label: UInt8[np.ndarray, "*count size size"]
    normal: Int8[np.ndarray, "*count size size 3"]
    chart: Float16[np.ndarray, "*count size size 2"]
    openness: UInt8[np.ndarray, "*count size size"]
    seen: UInt64[np.ndarray, "*count size size"]


class Facing(NamedTuple):
    """`normal`, `openness` and `seen` of `Buffers`, for the pixels that a surface is under."""

    normal: Int8[np.ndarray, "hits 3"]
    openness: UInt8[np.ndarray, "hits"]
    seen: UInt64[np.ndarray, "hits"]


def cast(head: Head, draw: np.random.Generator, size: int) -> Buffers:
    """A head from a side, distance and framing that are drawn by lot."""
    scene = Scene(Mesh(head.vertices, head.triangles, name="a synthetic head"))
    return buffers(head, scene, draw_view(draw, size))


def draw_view(draw: np.random.Generator, size: int) -> OrthographicView | PerspectiveView:
    """A camera that sees the head on half to three quarters of the picture's height."""
    turn = rotation(draw.normal(0, ANGLES).clip(-FARTHEST, FARTHEST))
    zoom = draw.uniform(0.48, 0.75)
    centre = draw.normal(0, (0.06, 0.08)).clip(-0.2, 0.2) + (0.0, 0.05)
    distance = draw.uniform(7.0, FAR)
    far = draw.random() < 0.25
    eye = np.array([*(-centre / zoom), FAR if far else distance]) @ turn
    scale = zoom * size / 2
    if far:
        return OrthographicView((size, size), eye, turn, scale)
    return PerspectiveView((size, size), eye, turn, scale * distance)


def rotation(angles: Float[np.ndarray, "3"]) -> Float[np.ndarray, "3 3"]:
    """From the head's axes to the camera's: pitch, then yaw, then roll."""
    (a, b, c), (p, q, r) = np.cos(angles), np.sin(angles)
    about_x = np.array([[1, 0, 0], [0, a, -p], [0, p, a]])
    about_y = np.array([[b, 0, q], [0, 1, 0], [-q, 0, b]])
    about_z = np.array([[c, -r, 0], [r, c, 0], [0, 0, 1]])
    return about_z @ about_y @ about_x


def buffers(head: Head, scene: Scene, view: OrthographicView | PerspectiveView) -> Buffers:
    """What a camera sees; `scene` is the head's mesh."""
    found = trace_geometry(scene, view)
    blank = _blank(view.size[0])
    hit, turn = found.hit, view.rotation
    corners = head.chart[head.triangles[found.triangle]]
    blank.label[hit] = head.label[found.triangle]
    blank.chart[hit] = np.einsum("pk,pkx->px", found.barycentric, corners)
    blank.normal[hit], blank.openness[hit], blank.seen[hit] = facing(found, turn)
    return blank


def facing(found: GeometryBuffers, turn: Float[np.ndarray, "3 3"]) -> Facing:
    """Where the surface under the pixels that hit it looks, and what light reaches it; the rows of
    `turn` are the camera's axes."""
    seen, open_ = _visibility(found, DIRECTIONS @ turn)
    normal = np.round(127 * found.normal @ turn.T).astype(np.int8)
    return Facing(normal, np.round(255 * open_).astype(np.uint8), seen)


def _blank(size: int) -> Buffers:
    label, open_ = (np.zeros((size, size), np.uint8) for _ in range(2))
    normal = np.zeros((size, size, 3), np.int8)
    chart = np.zeros((size, size, 2), np.float16)
    return Buffers(label, normal, chart, open_, np.full((size, size), ~np.uint64(0)))


def _visibility(
    found: GeometryBuffers, directions: Float[np.ndarray, "64 3"]
) -> tuple[UInt64[np.ndarray, "hits"], Float[np.ndarray, "hits"]]:
    seen = np.zeros(len(found.position), np.uint64)
    light, most = (np.zeros(len(found.position)) for _ in range(2))
    for k, direction in enumerate(directions):
        reached = found.light_visibility(direction)
        cosine = (found.normal @ direction).clip(0)
        seen |= (reached > 0).astype(np.uint64) << np.uint64(k)
        light, most = light + reached * cosine, most + cosine
    return seen, light / np.maximum(most, 1e-9)
