"""Symmetric Tutte embedding: a texture space for a face without one.

The boundary goes to a circle, every other vertex to a weighted mean of its neighbours (Tutte 1963).
With positive weights and a strictly convex boundary no triangle is flipped.
"""

import numpy as np
from jaxtyping import Float, Int
from scipy.sparse import coo_array, diags_array
from scipy.sparse.linalg import splu

from skinnet.errors import InputError
from skinnet.mesh._topology import boundary_loops, edge_keys, half_edges, label_components
from skinnet.texture.mirror import with_mirror_images

MARGIN = 1 / 128
"""Between the circle and the edge of the texture, so that filters stay inside it."""

LEAST_COTANGENT = 0.05
"""Smaller and negative ones count as this: Tutte's theorem asks for positive weights."""

ONE_SIDED = 0.1
"""Weight of an edge that only one side of the face has, relative to what it would be. With 0 a
vertex may be left with two neighbours; with 1 more of the other triangles flip."""

BALANCING = 2
"""Rounds in which springs are loosened where the texture is too small. On ICT-FaceKit's face the
5th percentile of texture per surface goes from .26 of the mean to .62; more rounds shear more."""

Vertices = Float[np.ndarray, "vertices 3"]
Points = Float[np.ndarray, "vertices 2"]
Triangles = Int[np.ndarray, "triangles 3"]
Partners = Int[np.ndarray, "vertices"]


def compute_tutte_embedding(
    vertices: Vertices, triangles: Triangles, mirror: Partners | None = None
) -> Points:
    """Texture coordinates [N, 2] in [0, 1] of a face with one outer boundary, up upwards.

    The longest boundary lies on a circle `MARGIN` inside the unit square, spaced by arc length and
    turned so that y points up and x to the right, as in a picture of the face. Other holes (eyes,
    mouth) are closed by a fan around a vertex in their middle, which is then forgotten. The weights
    are symmetric and positive: half the cotangents of the angles that face an edge, at least
    `LEAST_COTANGENT`, divided in `BALANCING` further rounds by the stretch of the last embedding
    (after Yoshizawa et al. 2004, made symmetric in the two ends).

    With `mirror`, the partner of each vertex (`find_mirror_vertices`), boundary and weights are averaged
    with their mirror images, and since the solution is unique it is symmetric about u = 1/2. Edges
    whose mirror image is no edge, such as the diagonals of quads that were all split the same way,
    count `ONE_SIDED` and so do their images: the faces of what remains without them are convex,
    however they are split. That is no proof, so triangles are checked. A triangle on the boundary
    without a mirror image gets one for the time being.

    Raises `InputError` for a mesh that is not one piece with the topology of a disc with holes, for
    vertices without a triangle, and for one that is not symmetric enough for its `mirror`.
    """
    _check_values(vertices, triangles, mirror)
    _check_one_piece(vertices, triangles)
    even = triangles if mirror is None else with_mirror_images(triangles, mirror)
    rim, holes = _rim_and_holes(vertices, even)
    closed = _fill(even, holes, len(vertices))
    points = np.concatenate([vertices, *(vertices[hole].mean(0)[None] for hole in holes)])
    _check_disc(closed, len(points))
    partner = np.arange(len(points)) if mirror is None else _with_holes(mirror, holes, rim)
    edges, weights = _springs(points, closed, partner)
    circle = _circle(vertices, rim, mirror)
    uv = _relaxed(edges, weights, rim, circle, len(points))
    for _ in range(BALANCING):
        stretch = _stretch(points, uv, closed)
        # The ends' stretch, and their partners', so that the weights stay symmetric.
        loose = np.sqrt(stretch * stretch[partner])
        weights = weights / np.sqrt(loose[edges[:, 0]] * loose[edges[:, 1]])
        uv = _relaxed(edges, weights, rim, circle, len(points))
    uv = uv[: len(vertices)]
    _check_flips(uv, triangles)
    return 0.5 + (0.5 - MARGIN) * uv


def count_flipped_triangles(uv: Points, triangles: Triangles) -> int:
    """Number of triangles that are not counter-clockwise."""
    a, b, c = np.moveaxis(uv[triangles], 1, 0)
    ab, ac = b - a, c - a
    return int((~(ab[:, 0] * ac[:, 1] - ab[:, 1] * ac[:, 0] > 0)).sum())


def _check_values(vertices: Vertices, triangles: Triangles, mirror: Partners | None) -> None:
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
            f"A mirror gives each of the {len(vertices)} vertices a partner whose partner it is; "
            "find it with find_mirror_vertices."
        )


def _check_one_piece(vertices: Vertices, triangles: Triangles) -> None:
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


def _rim_and_holes(
    vertices: Vertices, triangles: Triangles
) -> tuple[Int[np.ndarray, "rim"], list[Int[np.ndarray, "_"]]]:
    loops = boundary_loops(triangles)
    if not loops:
        raise InputError("The mesh to embed is closed; cut it open, for a head at the neck.")
    loops.sort(key=lambda loop: -_lengths(vertices[loop]).sum())
    return loops[0], loops[1:]


def _lengths(loop: Float[np.ndarray, "loop 3"]) -> Float[np.ndarray, "loop"]:
    """From each vertex of a closed curve to the next."""
    return np.asarray(np.linalg.norm(np.roll(loop, -1, 0) - loop, axis=1))


def _fill(
    triangles: Triangles, holes: list[Int[np.ndarray, "_"]], count: int
) -> Int[np.ndarray, "closed 3"]:
    fans = [
        np.stack([np.roll(hole, -1), hole, np.full(len(hole), count + i)], 1)
        for i, hole in enumerate(holes)
    ]
    return np.concatenate([triangles, *fans])


def _check_disc(triangles: Triangles, count: int) -> None:
    edges = len(np.unique(edge_keys(half_edges(triangles), count)))
    euler = count - edges + len(triangles)
    if euler != 1:
        raise InputError(
            f"The mesh to embed has {(1 - euler) // 2} handles once its holes are closed, and a "
            "disc has none; repair it first."
        )


def _with_holes(
    mirror: Partners, holes: list[Int[np.ndarray, "_"]], rim: Int[np.ndarray, "rim"]
) -> Int[np.ndarray, "points"]:
    """Partners of the vertices and of the holes' middles."""
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


def _springs(
    points: Vertices, triangles: Triangles, partner: Partners
) -> tuple[Int[np.ndarray, "edges 2"], Float[np.ndarray, "edges"]]:
    """Edges and their mirror images, with the mean of both weights."""
    count = len(points)
    edges = half_edges(triangles)
    weights = _cotangents(points[triangles]).ravel() / 2
    own, images = edge_keys(edges, count), edge_keys(partner[edges], count)
    keys, place = np.unique(np.concatenate([own, images]), return_inverse=True)
    total = np.bincount(place, np.tile(weights, 2))
    lone = ~(np.isin(keys, own) & np.isin(keys, images))
    return np.stack(np.divmod(keys, count), 1), np.where(lone, ONE_SIDED * total, total)


def _cotangents(corners: Float[np.ndarray, "triangles 3 3"]) -> Float[np.ndarray, "triangles 3"]:
    """Of the angle that faces edge k, from corner k to corner k + 1."""
    apex = np.roll(corners, -2, 1)
    a, b = corners - apex, np.roll(corners, -1, 1) - apex
    sine = np.linalg.norm(np.cross(a, b), axis=2)
    cotangent = np.asarray((a * b).sum(2) / np.maximum(sine, 1e-300))
    # A degenerate triangle's are as large as they like, and say nothing of the shape.
    return cotangent.clip(LEAST_COTANGENT, 1 / LEAST_COTANGENT)


def _circle(
    vertices: Vertices, rim: Int[np.ndarray, "rim"], mirror: Partners | None
) -> Float[np.ndarray, "rim 2"]:
    """Places of the rim on the unit circle, by arc length."""
    length = _lengths(vertices[rim])
    angle = 2 * np.pi * (np.cumsum(length) - length) / length.sum()
    x, y = (vertices[rim, :2] - vertices[rim, :2].mean(0)).T
    if mirror is None:
        # The rotation that brings the circle closest to the rim as seen from the front.
        wave = np.exp(-1j * angle)
        angle = angle + np.angle(((x + 1j * y) * wave).sum())
    else:
        across = np.argsort(rim)[np.searchsorted(np.sort(rim), mirror[rim])]
        # Mirrored, an angle is pi less itself. Two turns bring that about, half a circle apart.
        total = np.angle(np.exp(1j * (angle + angle[across])).mean())
        angle = angle + (np.pi - total) / 2
        angle = angle + np.pi * bool((x * np.cos(angle) + y * np.sin(angle)).sum() < 0)
        angle = angle + np.angle(np.exp(1j * (np.pi - angle[across] - angle))) / 2
    return np.stack([np.cos(angle), np.sin(angle)], 1)


def _relaxed(
    edges: Int[np.ndarray, "edges 2"],
    weights: Float[np.ndarray, "edges"],
    rim: Int[np.ndarray, "rim"],
    circle: Float[np.ndarray, "rim 2"],
    count: int,
) -> Points:
    """Every vertex off the rim at the weighted mean of its neighbours."""
    ends = np.concatenate([edges, edges[:, ::-1]])
    springs = coo_array((np.tile(weights, 2), tuple(ends.T)), (count, count)).tocsr()
    inner = np.ones(count, bool)
    inner[rim] = False
    laplacian = diags_array(springs.sum(1)) - springs
    uv = np.zeros((count, 2))
    uv[rim] = circle
    # Symmetric and positive definite: no pivoting, and an ordering that says so.
    system, options = laplacian[inner][:, inner].tocsc(), {"SymmetricMode": True}
    factor = splu(system, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0, options=options)
    uv[inner] = factor.solve(springs[inner][:, rim] @ circle)
    return uv


def _stretch(points: Vertices, uv: Points, triangles: Triangles) -> Float[np.ndarray, "vertices"]:
    """Root mean square length on the surface of a unit in the texture (Sander et al. 2001),
    averaged over the triangles around each vertex by their area."""
    a, b, c = np.moveaxis(points[triangles], 1, 0)
    area = np.linalg.norm(np.cross(b - a, c - a), axis=1)
    corners = uv[triangles]
    opposite = np.roll(corners, -1, 1) - np.roll(corners, -2, 1)
    (u1, v1), (u2, v2) = (corners[:, 1] - corners[:, 0]).T, (corners[:, 2] - corners[:, 0]).T
    double = np.maximum(np.abs(u1 * v2 - u2 * v1), 1e-30)
    slopes = np.einsum("tkc,tkx->tcx", opposite, points[triangles]) / double[:, None, None]
    squared = (slopes**2).sum((1, 2)) / 2
    flat = triangles.ravel()
    total = np.bincount(flat, np.repeat(area * squared, 3), len(points))
    around = np.bincount(flat, np.repeat(area, 3), len(points))
    return np.sqrt(np.maximum(total / np.maximum(around, 1e-300), 1e-12))


def _check_flips(uv: Points, triangles: Triangles) -> None:
    count = count_flipped_triangles(uv, triangles)
    if count:
        raise InputError(
            f"{count} triangles would be flipped or empty: the mesh differs too much from its "
            "mirror image, or has triangles without an area; embed it without a mirror, or repair "
            "it."
        )
