"""Preparation of a face for embedding as a topological disc: checks, rim, filled holes."""

import numpy as np
from jaxtyping import Float, Int

from skinnet.errors import InputError
from skinnet.mesh._topology import (
    compute_edge_keys,
    find_boundary_edges,
    label_components,
    list_boundary_loops,
    list_half_edges,
)
from skinnet.mesh._vectors import measure_edges


def check_values(
    vertices: Float[np.ndarray, "vertices 3"],
    triangles: Int[np.ndarray, "triangles 3"],
    mirror: Int[np.ndarray, "vertices"] | None,
) -> None:
    if not np.isfinite(vertices).all():
        raise InputError("The mesh to embed has vertices that are not finite; repair it first.")
    if triangles.size == 0 or triangles.min() < 0 or triangles.max() >= len(vertices):
        raise InputError(
            f"The mesh to embed needs triangles with corners from 0 to {len(vertices) - 1}."
        )
    count = np.arange(len(vertices))
    if mirror is not None and not (
        np.array_equal(np.sort(mirror), count) and np.array_equal(mirror[mirror], count)
    ):
        raise InputError(
            f"The mirror must pair each of the {len(vertices)} vertices with its mirror image; use "
            "find_mirror_vertices."
        )


def check_one_piece(
    vertices: Float[np.ndarray, "vertices 3"], triangles: Int[np.ndarray, "triangles 3"]
) -> None:
    used = np.bincount(triangles.ravel(), minlength=len(vertices)) > 0
    if not used.all():
        raise InputError(
            f"{(~used).sum()} of {len(vertices)} vertices belong to no triangle; remove them "
            "before embedding the mesh."
        )
    sizes = np.bincount(label_components(triangles, len(vertices)))
    if len(sizes) > 1:
        raise InputError(
            f"The mesh to embed has {len(sizes)} separate pieces, of "
            f"{', '.join(map(str, sorted(sizes.tolist(), reverse=True)[:4]))} vertices; keep one."
        )


def find_rim_and_holes(
    vertices: Float[np.ndarray, "vertices 3"], triangles: Int[np.ndarray, "triangles 3"]
) -> tuple[Int[np.ndarray, "rim"], list[Int[np.ndarray, "_"]]]:
    loops = list_boundary_loops(triangles)
    if not loops:
        raise InputError("The mesh to embed is closed; cut it open, for example at the neck.")
    loops.sort(key=lambda loop: -measure_edges(vertices[loop]).sum())
    return loops[0], loops[1:]


def fill_holes(
    triangles: Int[np.ndarray, "triangles 3"], holes: list[Int[np.ndarray, "_"]], count: int
) -> Int[np.ndarray, "closed 3"]:
    fans = [
        np.stack([np.roll(hole, -1), hole, np.full(len(hole), count + i)], 1)
        for i, hole in enumerate(holes)
    ]
    return np.concatenate([triangles, *fans])


def check_disc(triangles: Int[np.ndarray, "triangles 3"], count: int) -> None:
    edges = len(np.unique(compute_edge_keys(list_half_edges(triangles), count)))
    euler = count - edges + len(triangles)
    if euler != 1:
        raise InputError(
            f"The mesh to embed has {(1 - euler) // 2} handles once its holes are closed, and a "
            "disc has none; repair it first."
        )


def pair_holes(
    mirror: Int[np.ndarray, "vertices"],
    holes: list[Int[np.ndarray, "_"]],
    rim: Int[np.ndarray, "rim"],
) -> Int[np.ndarray, "points"]:
    """Extend the mirror from the vertices to the middles of the holes."""
    images = [frozenset(mirror[loop].tolist()) for loop in (rim, *holes)]
    places = {frozenset(loop.tolist()): i for i, loop in enumerate((rim, *holes))}
    lone = next((i for i, image in enumerate(images) if image not in places), None)
    if lone is not None:
        loop = (rim, *holes)[lone]
        lost = next((i for i in loop.tolist() if not any(mirror[i] in o for o in places)), loop[0])
        raise InputError(
            f"The mesh's boundary is not its own mirror image: vertex {lost} lies on it and its "
            f"partner {mirror[lost]} does not. Remove the triangle that only one side has, or "
            "embed without a mirror."
        )
    middles = [len(mirror) + places[image] - 1 for image in images[1:]]
    return np.concatenate([mirror, np.array(middles, mirror.dtype)])


def add_mirror_images(
    triangles: Int[np.ndarray, "triangles 3"], mirror: Int[np.ndarray, "vertices"]
) -> Int[np.ndarray, "more 3"]:
    """Add missing mirror images of triangles where they fill a notch of the boundary.

    A face that was cropped from a head of quads may keep half a quad on one side and not on the
    other. Only images that share two edges with the boundary are added.
    """
    count = len(mirror)
    while True:
        edges = list_half_edges(triangles)
        open_ = find_boundary_edges(triangles)
        keys = compute_edge_keys(edges, count, directed=True)
        rim = keys[open_.ravel()]
        lone = open_ & ~np.isin(
            compute_edge_keys(mirror[edges[:, ::-1]], count, True), rim
        ).reshape(-1, 3)
        images = mirror[triangles[lone.any(1)]][:, ::-1]
        sides = list_half_edges(images)
        new = ~np.isin(compute_edge_keys(sides, count, True), keys).reshape(-1, 3).any(1)
        joined = (
            np.isin(compute_edge_keys(sides[:, ::-1], count, True), rim).reshape(-1, 3).sum(1) == 2
        )
        if not (new & joined).any():
            return triangles
        triangles = np.concatenate([triangles, images[new & joined]])
