"""The texture of a scan, resampled into the texture space of a model fitted to it."""

from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float, Int

from skinnet.errors import InputError
from skinnet.images.srgb import srgb_to_linear
from skinnet.mesh._barycentric import interpolate
from skinnet.mesh._normals import compute_vertex_normals
from skinnet.mesh._sampling import sample_bilinear
from skinnet.mesh._topology import find_boundary_edges, label_components, weld
from skinnet.mesh._vectors import measure_edges, normalise
from skinnet.mesh.closest_point import ClosestPoints, TriangleTree
from skinnet.mesh.mesh import Mesh
from skinnet.texture.warp import TextureSpace, WarpedTexture, warp_texture

MAX_NORMAL_ANGLE = 60.0
"""Largest angle in degrees between the normals of model and scan at corresponding points."""

CUT_RATIO = 1.5
"""An edge crosses a cut of the scan's texture if its length in the texture is this many times what
the scan's own triangles at its ends imply. About 0.4 % of a real face's edges do."""

ON_EDGE = 1e-9
"""Barycentric coordinate below which a point lies on the opposite edge."""


class _ScanPositions(NamedTuple):
    """Closest points on the scan, undefined where not `covered`; `island` is the UV island."""

    covered: Bool[np.ndarray, "points"]
    position: Float[np.ndarray, "points 3"]
    uv: Float[np.ndarray, "points 2"]
    island: Int[np.ndarray, "points"]
    density: Float[np.ndarray, "points"]


def project_texture(
    space: TextureSpace,
    model_mesh: Mesh,
    scan: Mesh,
    max_distance: float,
    max_angle: float = MAX_NORMAL_ANGLE,
) -> WarpedTexture:
    """Resample a scan's texture into the texture space of a model fitted to the scan.

    Each vertex of the model takes the texture coordinates of the scan's closest point, and inside a
    triangle they are interpolated. A point is covered if the closest point is near enough, has a
    similar normal, and is not on the scan's boundary, beyond which there is no surface. Triangles
    with a corner that is not covered, or that a cut of the scan's texture crosses, are resampled
    texel by texel, each with its own closest point, under the same conditions and with one sample
    per texel.

    Args:
        space: The model's texture space.
        model_mesh: The fitted model, its triangles in the order of those of `space`.
        scan: The scan, with texture coordinates and a texture.
        max_distance: Largest distance between model and scan, in the scan's unit.
        max_angle: Largest angle between their normals, in degrees.

    Returns:
        The texture in linear sRGB, and the mask of the texels that the scan covers.

    Raises:
        InputError: If the scan has no texture or texture coordinates, or the model's triangles are
            not those of the texture space.

    Source:
        Section 4.2 of Alotaibi & Smith 2017.

    Example:
        >>> import numpy as np
        >>> from skinnet.mesh import Mesh
        >>> from skinnet.texture import TextureSpace, project_texture
        >>> corners = np.array([[-1.0, -1, 0], [3, -1, 0], [-1, 3, 0]])
        >>> triangle, uv = np.array([[0, 1, 2]]), np.array([[0.0, 0], [1, 0], [0, 1]])
        >>> white = np.full((4, 4, 3), 255, np.uint8)
        >>> scan = Mesh(corners, triangle, uv, triangle, white)
        >>> model_mesh = Mesh(corners / 4, triangle, uv, triangle)
        >>> space = TextureSpace(uv, triangle, 2)
        >>> project_texture(space, model_mesh, scan, max_distance=0.1).image[..., 0]
        array([[1., 0.],
               [1., 1.]], dtype=float32)
    """
    _check_textures(space, model_mesh, scan)
    source = _TexturedScan(scan, max_distance, np.cos(np.deg2rad(max_angle)))
    normals = compute_vertex_normals(model_mesh.vertices, model_mesh.triangles)
    places = source.locate(model_mesh.vertices, normals)
    coordinates = places.uv[model_mesh.triangles]
    known = places.covered[model_mesh.triangles]
    whole = known.all(1) & _find_whole(places, model_mesh.triangles)
    warped = warp_texture(space, coordinates, whole, source.texture)
    rest = np.flatnonzero((known.any(1) & ~whole)[space.texel_triangles])
    corners = np.concatenate([model_mesh.vertices, normals], 1)[model_mesh.triangles]
    position, normal = np.split(space.interpolate_texels(corners, rest), 2, axis=1)
    single = source.locate(position, normalise(normal))
    row, column = (index[rest][single.covered] for index in np.nonzero(space.mask))
    warped.image[row, column] = sample_bilinear(source.texture, single.uv[single.covered])
    warped.mask[row, column] = True
    return warped


class _TexturedScan:
    """A textured scan with a search structure for closest points."""

    def __init__(self, scan: Mesh, max_distance: float, min_cosine: float) -> None:
        assert scan.uv is not None and scan.uv_triangles is not None and scan.texture is not None
        self.max_distance, self.min_cosine = max_distance, min_cosine
        self.triangles, self.uv_triangles = scan.triangles, scan.uv_triangles
        self.vertices, self.uv = scan.vertices, scan.uv
        self.texture = srgb_to_linear(scan.texture)
        self.normals = compute_vertex_normals(scan.vertices, scan.triangles)
        self.surface = TriangleTree(scan.vertices, scan.triangles)
        islands = label_components(scan.uv_triangles, len(scan.uv))
        self.island = islands[scan.uv_triangles[:, 0]]
        welded = weld(scan.vertices)[scan.triangles]
        self.boundary = find_boundary_edges(welded)
        self.boundary_vertices = np.isin(welded, welded[self.boundary])
        self.boundary_vertices |= np.isin(welded, np.roll(welded, -1, 1)[self.boundary])
        self.density = _compute_density(scan.vertices[scan.triangles], scan.uv[scan.uv_triangles])

    def locate(
        self, points: Float[np.ndarray, "points 3"], normals: Float[np.ndarray, "points 3"]
    ) -> _ScanPositions:
        """Find the closest points, and whether each is on the same part of the surface."""
        closest = self.surface.query(points, self.max_distance)
        triangle = closest.triangle
        normal = normalise(interpolate(closest.barycentric, self.normals[self.triangles[triangle]]))
        agrees = np.einsum("px,px->p", normal, normals) >= self.min_cosine
        return _ScanPositions(
            (triangle >= 0) & agrees & ~self._lies_on_boundary(closest),
            interpolate(closest.barycentric, self.vertices[self.triangles[triangle]]),
            interpolate(closest.barycentric, self.uv[self.uv_triangles[triangle]]),
            self.island[triangle],
            self.density[triangle],
        )

    def _lies_on_boundary(self, closest: ClosestPoints) -> Bool[np.ndarray, "points"]:
        """Tell which points lie on the boundary; edge k lies opposite corner k + 2."""
        on_edge = np.roll(closest.barycentric <= ON_EDGE, -2, 1) & self.boundary[closest.triangle]
        at_corner = closest.barycentric >= 1 - ON_EDGE
        at_corner &= self.boundary_vertices[closest.triangle]
        return np.asarray((on_edge | at_corner).any(1))


def _compute_density(
    corners: Float[np.ndarray, "triangles 3 3"], uv: Float[np.ndarray, "triangles 3 2"]
) -> Float[np.ndarray, "triangles"]:
    """Compute the largest ratio of an edge's length in the texture to that on the surface."""
    length = measure_edges(corners)
    return np.asarray((measure_edges(uv) / np.where(length > 0, length, np.inf)).max(1))


def _find_whole(
    places: _ScanPositions, triangles: Int[np.ndarray, "triangles 3"]
) -> Bool[np.ndarray, "triangles"]:
    """Find triangles that no cut of the scan's texture crosses."""
    island, density = places.island[triangles], places.density[triangles]
    length = measure_edges(places.position[triangles])
    expected = CUT_RATIO * np.maximum(density, np.roll(density, -1, 1)) * length
    whole = measure_edges(places.uv[triangles]) <= expected + 1e-6
    return np.asarray((island == island[:, :1]).all(1) & whole.all(1))


def _check_textures(space: TextureSpace, model_mesh: Mesh, scan: Mesh) -> None:
    if scan.uv is None or scan.uv_triangles is None:
        raise InputError(
            f"{scan.name} has no texture coordinates, so its texture cannot be placed; export the "
            "scan with them."
        )
    if scan.texture is None:
        raise InputError(f"{scan.name} has no texture; give the picture that belongs to it.")
    if len(model_mesh.triangles) != len(space.triangles):
        raise InputError(
            f"{model_mesh.name} has {len(model_mesh.triangles)} triangles and the texture space "
            f"{len(space.triangles)}; make the texture space from the same model."
        )
