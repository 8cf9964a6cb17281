"""The texture of a scan carried over to a model fitted to it."""

from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float, Int

from skinnet.errors import InputError
from skinnet.images.srgb import srgb_to_linear
from skinnet.mesh._topology import boundary, label_components, weld
from skinnet.mesh._vectors import normalise
from skinnet.mesh.closest_point import ClosestPoints, TriangleTree
from skinnet.mesh.mesh import Mesh
from skinnet.mesh.normals import compute_vertex_normals
from skinnet.mesh.sampling import sample_bilinear
from skinnet.texture.warp import TextureSpace, WarpedTexture, warp_texture

MAX_NORMAL_ANGLE = 60.0
"""Degrees between the normals of model and scan from which a point is not the same one."""

TORN = 1.5
"""How many times longer in the scan's texture an edge may be than the scan's own triangles there
would make it, before it counts as one that crosses a cut. Some 0.4 % of a real face's do."""

ON_EDGE = 1e-9
"""Barycentric coordinate below which a point lies on the opposite edge."""


class _Places(NamedTuple):
    """Where points of the model lie on the scan; meaningless where not `covered`."""

    covered: Bool[np.ndarray, "points"]
    position: Float[np.ndarray, "points 3"]
    uv: Float[np.ndarray, "points 2"]
    chart: Int[np.ndarray, "points"]
    density: Float[np.ndarray, "points"]


def project_texture(
    space: TextureSpace,
    fitted: Mesh,
    scan: Mesh,
    limit: float,
    normal_limit: float = MAX_NORMAL_ANGLE,
) -> WarpedTexture:
    """The scan's texture in the model's space, linear sRGB, masked where the scan has none.

    Each vertex of `fitted`, whose triangles are those of `space` in the same order, takes the
    texture coordinate of the scan's closest point (paper 4.2); inside a triangle they are
    interpolated. A point is not covered if the closest one is farther than `limit` (in the scan's
    unit), if the normals differ by more than `normal_limit` degrees, or if it lies on the scan's
    open edge, beyond which nothing was measured. Triangles with a corner that is not covered, or
    whose corners lie on different charts of the scan's texture or on both sides of a cut, are done
    texel by texel, each with its own closest point and the same conditions; there one sample is
    taken, not the mean over a texel's footprint.

    Raises `InputError` for a scan without texture or texture coordinates, and for a fitted mesh
    with other triangles than the texture space.
    """
    _check(space, fitted, scan)
    source = _Scan(scan, limit, np.cos(np.deg2rad(normal_limit)))
    normals = compute_vertex_normals(fitted.vertices, fitted.triangles)
    places = source.places(fitted.vertices, normals)
    coordinates = places.uv[fitted.triangles]
    known = places.covered[fitted.triangles]
    whole = known.all(1) & _untorn(places, fitted.triangles)
    warped = warp_texture(space, coordinates, whole, source.texture)
    rest = np.flatnonzero((known.any(1) & ~whole)[space.owner])
    corners = np.concatenate([fitted.vertices, normals], 1)[fitted.triangles]
    position, normal = np.split(space.at(corners, rest), 2, axis=1)
    single = source.places(position, normalise(normal))
    row, column = (index[rest][single.covered] for index in np.nonzero(space.mask))
    warped.image[row, column] = sample_bilinear(source.texture, single.uv[single.covered])
    warped.mask[row, column] = True
    return warped


class _Scan:
    """A textured scan that is asked for closest points."""

    def __init__(self, scan: Mesh, limit: float, least_cosine: float):
        assert scan.uv is not None and scan.uv_triangles is not None and scan.texture is not None
        self.limit, self.least_cosine = limit, least_cosine
        self.triangles, self.uv_triangles = scan.triangles, scan.uv_triangles
        self.vertices, self.uv = scan.vertices, scan.uv
        self.texture = srgb_to_linear(scan.texture)
        self.normals = compute_vertex_normals(scan.vertices, scan.triangles)
        self.surface = TriangleTree(scan.vertices, scan.triangles)
        charts = label_components(scan.uv_triangles, len(scan.uv))
        self.chart = charts[scan.uv_triangles[:, 0]]
        welded = weld(scan.vertices)[scan.triangles]
        self.open = boundary(welded)
        self.open_vertices = np.isin(welded, welded[self.open])
        self.open_vertices |= np.isin(welded, np.roll(welded, -1, 1)[self.open])
        self.density = _density(scan.vertices[scan.triangles], scan.uv[scan.uv_triangles])

    def places(
        self, points: Float[np.ndarray, "points 3"], normals: Float[np.ndarray, "points 3"]
    ) -> _Places:
        """Closest points within the limit, and whether each shows the same piece of surface."""
        closest = self.surface.query(points, self.limit)
        triangle = closest.triangle
        normal = normalise(_mean(closest, self.normals[self.triangles[triangle]]))
        agrees = np.einsum("px,px->p", normal, normals) >= self.least_cosine
        return _Places(
            (triangle >= 0) & agrees & ~self._on_open_edge(closest),
            _mean(closest, self.vertices[self.triangles[triangle]]),
            _mean(closest, self.uv[self.uv_triangles[triangle]]),
            self.chart[triangle],
            self.density[triangle],
        )

    def _on_open_edge(self, closest: ClosestPoints) -> Bool[np.ndarray, "points"]:
        """Edge k lies opposite corner k + 2."""
        on_edge = np.roll(closest.barycentric <= ON_EDGE, -2, 1) & self.open[closest.triangle]
        at_corner = closest.barycentric >= 1 - ON_EDGE
        at_corner &= self.open_vertices[closest.triangle]
        return np.asarray((on_edge | at_corner).any(1))


def _density(
    corners: Float[np.ndarray, "triangles 3 3"], uv: Float[np.ndarray, "triangles 3 2"]
) -> Float[np.ndarray, "triangles"]:
    """Length in the texture of a unit on the surface, the largest of the three edges'."""
    length = _edges(corners)
    return np.asarray((_edges(uv) / np.where(length > 0, length, np.inf)).max(1))


def _mean(
    closest: ClosestPoints, corners: Float[np.ndarray, "points 3 k"]
) -> Float[np.ndarray, "points k"]:
    return np.asarray(np.einsum("pk,pkx->px", closest.barycentric, corners))


def _edges(corners: Float[np.ndarray, "triangles 3 k"]) -> Float[np.ndarray, "triangles 3"]:
    return np.asarray(np.linalg.norm(np.roll(corners, -1, 1) - corners, axis=2))


def _untorn(
    places: _Places, triangles: Int[np.ndarray, "triangles 3"]
) -> Bool[np.ndarray, "triangles"]:
    """Triangles whose corners lie together in the scan's texture as they do on the scan."""
    chart, density = places.chart[triangles], places.density[triangles]
    length = _edges(places.position[triangles])
    expected = TORN * np.maximum(density, np.roll(density, -1, 1)) * length
    untorn = _edges(places.uv[triangles]) <= expected + 1e-6
    return np.asarray((chart == chart[:, :1]).all(1) & untorn.all(1))


def _check(space: TextureSpace, fitted: Mesh, scan: Mesh) -> None:
    if scan.uv is None or scan.uv_triangles is None:
        raise InputError(
            f"{scan.name} has no texture coordinates, so its texture cannot be placed; export the "
            "scan with them."
        )
    if scan.texture is None:
        raise InputError(f"{scan.name} has no texture; give the picture that belongs to it.")
    if len(fitted.triangles) != len(space.triangles):
        raise InputError(
            f"{fitted.name} has {len(fitted.triangles)} triangles and the texture space "
            f"{len(space.triangles)}; make the texture space from the same model."
        )
