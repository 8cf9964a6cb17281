"""Symmetric Tutte embedding: a texture space for a face without one.

The boundary is placed on a circle, and every other vertex at a weighted mean of its neighbours
(Tutte 1963). With positive weights and a strictly convex boundary no triangle is flipped.
"""

import numpy as np
from jaxtyping import Float, Int
from scipy.sparse import coo_array, diags_array
from scipy.sparse.linalg import splu

from skinnet.errors import InputError
from skinnet.mesh._topology import compute_edge_keys, list_half_edges
from skinnet.mesh._vectors import measure_edges
from skinnet.texture._disc import (
    add_mirror_images,
    check_disc,
    check_one_piece,
    check_values,
    fill_holes,
    find_rim_and_holes,
    pair_holes,
)
from skinnet.texture._flips import count_flipped_triangles

MARGIN = 1 / 128
"""Distance of the circle from the edge of the texture, so that filters stay inside."""

MIN_COTANGENT = 0.05
"""Lower limit of cotangents, because Tutte's theorem needs positive weights."""

ONE_SIDED = 0.1
"""Factor on the weight of an edge whose mirror image is no edge. With 0 a vertex may have only two
neighbours; with 1 more triangles are flipped."""

BALANCING_ROUNDS = 2
"""Rounds that lower the weights where triangles are too small in the texture. On ICT-FaceKit's face
the 5th percentile of texture area per surface area rises from .26 of the mean to .62; more rounds
shear triangles more."""


def compute_tutte_embedding(
    vertices: Float[np.ndarray, "vertices 3"],
    triangles: Int[np.ndarray, "triangles 3"],
    mirror: Int[np.ndarray, "vertices"] | None = None,
) -> Float[np.ndarray, "vertices 2"]:
    """Embed a face in the unit square: a symmetric texture space without flipped triangles.

    The longest boundary is placed on a circle, spaced by arc length. Other holes (eyes, mouth) are
    closed by a fan of triangles around their middle, which are removed afterwards. The weights are
    symmetric and positive: half the cotangents of the angles opposite an edge, divided in two
    further rounds by the stretch of the last embedding.

    With `mirror`, boundary and weights are averaged with their mirror images. The solution is
    unique, so it is symmetric about u = 1/2. Edges whose mirror image is no edge, such as the
    diagonals of quads that were all split in one direction, get a small weight. With weight 0 the
    quads would be convex, and any diagonal would be valid; for small weights nothing is proved, so
    flipped triangles are counted. A triangle on the boundary without a mirror image gets one while
    weights are computed.

    Args:
        vertices: Vertices of a face with one outer boundary, y up and x to the face's left.
        triangles: Vertices of each triangle, counter-clockwise from outside.
        mirror: The mirror image of each vertex (`find_mirror_vertices`); None for an embedding that
            need not be symmetric.

    Returns:
        Texture coordinates in [0, 1], u along x and v along y as in a picture of the face.

    Raises:
        InputError: If the mesh is not one piece with the topology of a disc with holes, a vertex
            has no triangle, or the mesh is not symmetric enough for its `mirror`.

    Source:
        Section 4.2 of Alotaibi & Smith 2017, which uses the symmetric embedding of Bas et al.;
        Tutte 1963; weights after Yoshizawa et al. 2004, made symmetric in an edge's two ends.

    Example:
        >>> import numpy as np
        >>> from skinnet.texture import compute_tutte_embedding
        >>> square = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0.3, 0.4, 0.2]])
        >>> fan = np.array([[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]])
        >>> compute_tutte_embedding(square, fan).round(2)
        array([[0.15, 0.15],
               [0.85, 0.15],
               [0.85, 0.85],
               [0.15, 0.85],
               [0.37, 0.44]])
    """
    check_values(vertices, triangles, mirror)
    check_one_piece(vertices, triangles)
    paired = triangles if mirror is None else add_mirror_images(triangles, mirror)
    rim, holes = find_rim_and_holes(vertices, paired)
    closed = fill_holes(paired, holes, len(vertices))
    points = np.concatenate([vertices, *(vertices[hole].mean(0)[None] for hole in holes)])
    check_disc(closed, len(points))
    partner = np.arange(len(points)) if mirror is None else pair_holes(mirror, holes, rim)
    edges, weights = _compute_weights(points, closed, partner)
    circle = _place_on_circle(vertices, rim, mirror)
    uv = _solve_laplacian(edges, weights, rim, circle, len(points))
    for _ in range(BALANCING_ROUNDS):
        stretch = _compute_stretch(points, uv, closed)
        # The mean of both ends and both sides keeps the weights symmetric.
        balanced = np.sqrt(stretch * stretch[partner])
        weights = weights / np.sqrt(balanced[edges[:, 0]] * balanced[edges[:, 1]])
        uv = _solve_laplacian(edges, weights, rim, circle, len(points))
    uv = uv[: len(vertices)]
    _check_flips(uv, triangles)
    return 0.5 + (0.5 - MARGIN) * uv


def _compute_weights(
    points: Float[np.ndarray, "vertices 3"],
    triangles: Int[np.ndarray, "triangles 3"],
    partner: Int[np.ndarray, "vertices"],
) -> tuple[Int[np.ndarray, "edges 2"], Float[np.ndarray, "edges"]]:
    """List edges and their mirror images, with the mean of both weights."""
    count = len(points)
    edges = list_half_edges(triangles)
    weights = _compute_cotangents(points[triangles]).ravel() / 2
    own, images = compute_edge_keys(edges, count), compute_edge_keys(partner[edges], count)
    keys, place = np.unique(np.concatenate([own, images]), return_inverse=True)
    total = np.bincount(place, np.tile(weights, 2))
    lone = ~(np.isin(keys, own) & np.isin(keys, images))
    return np.stack(np.divmod(keys, count), 1), np.where(lone, ONE_SIDED * total, total)


def _compute_cotangents(
    corners: Float[np.ndarray, "triangles 3 3"],
) -> Float[np.ndarray, "triangles 3"]:
    """Compute the cotangent of the angle opposite edge k, from corner k to corner k + 1."""
    apex = np.roll(corners, -2, 1)
    a, b = corners - apex, np.roll(corners, -1, 1) - apex
    sine = np.linalg.norm(np.cross(a, b), axis=2)
    cotangent = np.asarray((a * b).sum(2) / np.maximum(sine, 1e-300))
    # Cotangents of a degenerate triangle are arbitrarily large and carry no information.
    return cotangent.clip(MIN_COTANGENT, 1 / MIN_COTANGENT)


def _place_on_circle(
    vertices: Float[np.ndarray, "vertices 3"],
    rim: Int[np.ndarray, "rim"],
    mirror: Int[np.ndarray, "vertices"] | None,
) -> Float[np.ndarray, "rim 2"]:
    """Place the rim on the unit circle, by arc length."""
    length = measure_edges(vertices[rim])
    angle = 2 * np.pi * (np.cumsum(length) - length) / length.sum()
    x, y = (vertices[rim, :2] - vertices[rim, :2].mean(0)).T
    if mirror is None:
        # The rotation that brings the circle closest to the rim in a front view.
        wave = np.exp(-1j * angle)
        angle = angle + np.angle(((x + 1j * y) * wave).sum())
    else:
        across = np.argsort(rim)[np.searchsorted(np.sort(rim), mirror[rim])]
        # The mirror image of an angle is pi minus the angle. Two rotations of the circle achieve
        # that, half a circle apart.
        total = np.angle(np.exp(1j * (angle + angle[across])).mean())
        angle = angle + (np.pi - total) / 2
        angle = angle + np.pi * bool((x * np.cos(angle) + y * np.sin(angle)).sum() < 0)
        angle = angle + np.angle(np.exp(1j * (np.pi - angle[across] - angle))) / 2
    return np.stack([np.cos(angle), np.sin(angle)], 1)


def _solve_laplacian(
    edges: Int[np.ndarray, "edges 2"],
    weights: Float[np.ndarray, "edges"],
    rim: Int[np.ndarray, "rim"],
    circle: Float[np.ndarray, "rim 2"],
    count: int,
) -> Float[np.ndarray, "vertices 2"]:
    """Place every vertex off the rim at the weighted mean of its neighbours."""
    ends = np.concatenate([edges, edges[:, ::-1]])
    adjacency = coo_array((np.tile(weights, 2), tuple(ends.T)), (count, count)).tocsr()
    inner = np.ones(count, bool)
    inner[rim] = False
    laplacian = diags_array(adjacency.sum(1)) - adjacency
    uv = np.zeros((count, 2))
    uv[rim] = circle
    # The matrix is symmetric and positive definite, so no pivoting is needed.
    system, options = laplacian[inner][:, inner].tocsc(), {"SymmetricMode": True}
    factor = splu(system, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0, options=options)
    uv[inner] = factor.solve(adjacency[inner][:, rim] @ circle)
    return uv


def _compute_stretch(
    points: Float[np.ndarray, "vertices 3"],
    uv: Float[np.ndarray, "vertices 2"],
    triangles: Int[np.ndarray, "triangles 3"],
) -> Float[np.ndarray, "vertices"]:
    """Compute each vertex's stretch (Sander et al. 2001).

    That is the root mean square length on the surface of a unit in the texture, averaged over the
    triangles at the vertex by their area.
    """
    a, b, c = np.moveaxis(points[triangles], 1, 0)
    area = np.linalg.norm(np.cross(b - a, c - a), axis=1)
    corners = uv[triangles]
    opposite = np.roll(corners, -1, 1) - np.roll(corners, -2, 1)
    (u1, v1), (u2, v2) = (corners[:, 1] - corners[:, 0]).T, (corners[:, 2] - corners[:, 0]).T
    double = np.maximum(np.abs(u1 * v2 - u2 * v1), 1e-30)
    gradients = np.einsum("tkc,tkx->tcx", opposite, points[triangles]) / double[:, None, None]
    squared = (gradients**2).sum((1, 2)) / 2
    flat = triangles.ravel()
    total = np.bincount(flat, np.repeat(area * squared, 3), len(points))
    weight = np.bincount(flat, np.repeat(area, 3), len(points))
    return np.sqrt(np.maximum(total / np.maximum(weight, 1e-300), 1e-12))


def _check_flips(
    uv: Float[np.ndarray, "vertices 2"], triangles: Int[np.ndarray, "triangles 3"]
) -> None:
    count = count_flipped_triangles(uv, triangles)
    if count:
        raise InputError(
            f"{count} triangles would be flipped or empty: the mesh differs too much from its "
            "mirror image, or has triangles without an area; embed it without a mirror, or repair "
            "it."
        )
