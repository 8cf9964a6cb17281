"""Geometry buffers of synthetic heads: rays are cast once, light is added on every step."""

from typing import NamedTuple

import numpy as np
import torch
from jaxtyping import Bool, Float, Float16, Int8, UInt8, UInt64

from skinnet.mesh import Mesh
from skinnet.render import (
    GeometryBuffers,
    OrthographicView,
    PerspectiveView,
    Scene,
    trace_geometry,
)
from train.synthetic.bodies.labelled_mesh import LabelledMesh
from train.synthetic.casts.directions import LIGHT_DIRECTIONS
from train.synthetic.labels import BACKGROUND, CLEAR_LENS, FILM, MATERIALS
from train.synthetic.scene import HeadBuffers
from train.synthetic.subjects.framing import make_view, sample_portrait_framing


class HeadCast(NamedTuple):
    """`HeadBuffers` of one head, or of several with one axis more, as they are kept on disk."""

    label: UInt8[np.ndarray, "*count size size"]
    normal: Int8[np.ndarray, "*count size size 3"]
    chart: Float16[np.ndarray, "*count size size 2"]
    sky_visibility: UInt8[np.ndarray, "*count size size"]
    visibility_mask: UInt64[np.ndarray, "*count size size"]

    def to_buffers(self) -> HeadBuffers:
        """Return the same memory as tensors.

        The masks become signed integers, which torch can shift; their bits do not change.
        """
        signed = self.visibility_mask.view(np.int64)
        return HeadBuffers(*(torch.from_numpy(one) for one in (*self[:4], signed)))


class SurfaceCast(NamedTuple):
    """`normal`, `sky_visibility` and `visibility_mask` of the pixels that show a surface."""

    normal: Int8[np.ndarray, "hits 3"]
    sky_visibility: UInt8[np.ndarray, "hits"]
    visibility_mask: UInt64[np.ndarray, "hits"]


def cast_head(head: LabelledMesh, rng: np.random.Generator, size: int) -> HeadCast:
    """Cast a head from a random side, distance and framing.

    Args:
        head: A whole head.
        rng: Random numbers.
        size: Side of the picture in pixels.

    Returns:
        Its buffers.
    """
    scene = Scene(Mesh(head.vertices, head.triangles, name="a synthetic head"))
    view = make_view(sample_portrait_framing(rng), np.zeros(3), size)
    return cast_view(head, scene, view)


def cast_view(
    head: LabelledMesh, scene: Scene, view: OrthographicView | PerspectiveView
) -> HeadCast:
    """Cast what a camera sees of a head.

    Args:
        head: A whole head.
        scene: The mesh of the same head.
        view: The camera, with a square picture.

    Returns:
        Its buffers.
    """
    clear = head.label % MATERIALS == CLEAR_LENS
    if clear.any():
        return _cast_behind(head, clear, view)
    surface = trace_geometry(scene, view)
    cast = make_blank_cast(view.size[0])
    hit = surface.hit
    corners = head.chart[head.triangles[surface.triangle]]
    cast.label[hit] = head.label[surface.triangle]
    cast.chart[hit] = np.einsum("pk,pkx->px", surface.barycentric, corners)
    values = cast_surface(surface, view.rotation)
    cast.normal[hit], cast.sky_visibility[hit], cast.visibility_mask[hit] = values
    return cast


def _cast_behind(
    head: LabelledMesh,
    clear: Bool[np.ndarray, "triangles"],
    view: OrthographicView | PerspectiveView,
) -> HeadCast:
    """Cast what is seen through clear lenses, whose label is then `FILM` more."""
    parts = [
        LabelledMesh(head.vertices, head.triangles[chosen], head.label[chosen], head.chart)
        for chosen in (~clear, clear)
    ]
    rest, lenses = (Scene(Mesh(part.vertices, part.triangles)) for part in parts)
    cast = cast_view(parts[0], rest, view)
    before = _measure_height(lenses, view) > _measure_height(rest, view)
    cast.label[before & (cast.label % MATERIALS != BACKGROUND)] += FILM
    return cast


def _measure_height(
    scene: Scene, view: OrthographicView | PerspectiveView
) -> Float[np.ndarray, "size size"]:
    """Place of the surface along the camera's axis, towards the camera."""
    surface = trace_geometry(scene, view)
    height = np.full(view.size, -np.inf)
    height[surface.hit] = surface.position @ view.rotation[2]
    return height


def cast_surface(surface: GeometryBuffers, axes: Float[np.ndarray, "3 3"]) -> SurfaceCast:
    """Find the normals of a visible surface, and what light reaches it.

    Args:
        surface: The surface under each pixel.
        axes: The camera's axes in rows.

    Returns:
        Values of the pixels that show the surface.
    """
    mask, sky = _find_visibility(surface, LIGHT_DIRECTIONS @ axes)
    normal = np.round(127 * surface.normal @ axes.T).astype(np.int8)
    return SurfaceCast(normal, np.round(255 * sky).astype(np.uint8), mask)


def make_blank_cast(size: int) -> HeadCast:
    """Make the buffers of a picture of the background alone."""
    label, sky = (np.zeros((size, size), np.uint8) for _ in range(2))
    normal = np.zeros((size, size, 3), np.int8)
    chart = np.zeros((size, size, 2), np.float16)
    return HeadCast(label, normal, chart, sky, np.full((size, size), ~np.uint64(0)))


def _find_visibility(
    surface: GeometryBuffers, directions: Float[np.ndarray, "64 3"]
) -> tuple[UInt64[np.ndarray, "hits"], Float[np.ndarray, "hits"]]:
    mask = np.zeros(len(surface.position), np.uint64)
    visible, total = (np.zeros(len(surface.position)) for _ in range(2))
    for k, direction in enumerate(directions):
        reached = surface.light_visibility(direction)
        cosine = (surface.normal @ direction).clip(0)
        mask |= (reached > 0).astype(np.uint64) << np.uint64(k)
        visible, total = visible + reached * cosine, total + cosine
    return mask, visible / np.maximum(total, 1e-9)
