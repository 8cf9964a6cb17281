"""A fitted face as other tools expect it: metres, y up, looking along z, with its textures."""

import io
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from jaxtyping import Float, Int, UInt8, UInt16
from PIL import Image
from PIL.PngImagePlugin import PngInfo
from scipy.ndimage import distance_transform_edt

from skinnet.appearance.colour import SkinColour
from skinnet.appearance.skin_texture import SkinTexture
from skinnet.errors import InputError
from skinnet.images.srgb import linear_to_srgb, to_uint8
from skinnet.mesh._barycentric import interpolate
from skinnet.mesh._normals import compute_vertex_normals
from skinnet.mesh._vectors import normalise
from skinnet.mesh.closest_point import TriangleTree
from skinnet.mesh.mesh import Mesh
from skinnet.mesh.raster import rasterise

LEVELS = 65535
"""The largest pixel of a pigment map."""

ROUGHNESS, IOR = 0.45, 1.4
"""Roughness, and refractive index, of skin's surface in renderers."""

_MAX_ANGLE = 60.0
"""Angle in degrees between the normals of face and scan beyond which a scan's detail is not used"""

_LIMIT = 0.005
"""Distance in metres between face and scan beyond which a scan's detail is not used."""

PIGMENTS = {"melanin": "f_mel", "hemoglobin": "f_blood"}


@dataclass(frozen=True)
class Head:
    """A face with one position, normal, tangent and texture coordinate at each corner.

    Attributes:
        positions: In metres, x to the face's left, y up, z forward.
        normals: Unit normals, smooth across seams of the texture.
        tangents: Unit vectors along u, and the sign of the third axis.
        uv: Texture coordinates with the origin at the lower left.
        triangles: Indices of corners, counter-clockwise seen from outside.
        albedo: sRGB.
        normal_map: Normals in the frame of tangent, third axis and normal; 0 to 255 is -1 to 1.
        pigments: Maps of melanin and hemoglobin; a fraction is scale * pixel.
        scales: Volume fraction of one step of each pigment map.
        facts: What a file states of the maps, in primitives.
        mark: What the pictures in a file state of its origin, by keyword.
    """

    positions: Float[np.ndarray, "points 3"]
    normals: Float[np.ndarray, "points 3"]
    tangents: Float[np.ndarray, "points 4"]
    uv: Float[np.ndarray, "points 2"]
    triangles: Int[np.ndarray, "triangles 3"]
    albedo: UInt8[np.ndarray, "size size 3"]
    normal_map: UInt8[np.ndarray, "size size 3"]
    pigments: dict[str, UInt16[np.ndarray, "size size"]]
    scales: dict[str, float]
    facts: dict[str, Any]
    mark: dict[str, str]


def make_head(
    mesh: Mesh,
    texture: SkinTexture,
    colour: SkinColour,
    scan: Mesh | None,
    mark: Mapping[str, str] | None = None,
) -> Head:
    """Make a head from a face in metres, its maps, and the scan in the same frame.

    Texels that are not known get the values of the nearest ones that are, so that no border shows.

    Raises:
        InputError: The face has no texture coordinates, or no texel is known.
    """
    if mesh.uv is None or mesh.uv_triangles is None:
        raise InputError(
            f"{mesh.name} has no texture coordinates, so maps cannot be placed on it; give a face "
            "that skinnet maps wrote."
        )
    if not texture.mask.any():
        raise InputError(f"{texture.name}: no texel is known; make the maps again.")
    corners, triangles = _split_corners(mesh)
    positions, uv = mesh.vertices[corners[:, 0]], mesh.uv[corners[:, 1]]
    normals = compute_vertex_normals(mesh.vertices, mesh.triangles)[corners[:, 0]]
    tangents = _compute_tangents(positions, normals, uv, triangles)
    fill = distance_transform_edt(~texture.mask, return_distances=False, return_indices=True)
    rows, columns = fill
    fractions = {
        name: getattr(texture, part)[rows, columns].clip(0, 1) for name, part in PIGMENTS.items()
    }
    scales = {name: float(values.max()) / LEVELS or 1.0 for name, values in fractions.items()}
    albedo = to_uint8(linear_to_srgb(texture.albedo(colour)[rows, columns]))
    facts = {"light": colour.light, "camera": colour.camera, "optics": colour.optics}
    bare = (positions, normals, tangents, uv, triangles)
    return Head(
        *bare,
        albedo,
        _bake_normals(bare, len(texture.mask), scan),
        {
            name: np.rint(values / scales[name]).astype(np.uint16)
            for name, values in fractions.items()
        },
        scales,
        facts,
        dict(mark or {}),
    )


def encode_png(pixels: Any, text: Mapping[str, str]) -> bytes:
    """Encode a picture as PNG, with a mark by which the file is known as a result."""
    info = PngInfo()
    for keyword, line in text.items():
        info.add_text(keyword, line)
    file = io.BytesIO()
    Image.fromarray(pixels).save(file, "PNG", pnginfo=info)
    return file.getvalue()


def _split_corners(
    mesh: Mesh,
) -> tuple[Int[np.ndarray, "points 2"], Int[np.ndarray, "triangles 3"]]:
    """Find the distinct pairs of vertex and texture coordinate, and triangles of these."""
    assert mesh.uv_triangles is not None
    pairs = np.stack([mesh.triangles.ravel(), mesh.uv_triangles.ravel()], 1)
    distinct, places = np.unique(pairs, axis=0, return_inverse=True)
    return distinct, places.reshape(-1, 3)


def _compute_tangents(
    positions: Float[np.ndarray, "points 3"],
    normals: Float[np.ndarray, "points 3"],
    uv: Float[np.ndarray, "points 2"],
    triangles: Int[np.ndarray, "triangles 3"],
) -> Float[np.ndarray, "points 4"]:
    """Compute the direction of u at each corner, and whether v runs along normal x tangent."""
    a, b, c = np.moveaxis(positions[triangles], 1, 0)
    ua, ub, uc = np.moveaxis(uv[triangles], 1, 0)
    (du1, dv1), (du2, dv2) = (ub - ua).T, (uc - ua).T
    area = du1 * dv2 - du2 * dv1
    along = np.sign(area)[:, None] * ((b - a) * dv2[:, None] - (c - a) * dv1[:, None])
    summed = np.stack(
        [
            np.bincount(triangles.ravel(), np.repeat(part, 3), len(positions))
            for part in normalise(along).T
        ],
        1,
    )
    summed -= np.einsum("px,px->p", summed, normals)[:, None] * normals
    sign = np.bincount(triangles.ravel(), np.repeat(np.sign(area), 3), len(positions))
    return np.concatenate([normalise(summed), np.where(sign < 0, -1.0, 1.0)[:, None]], 1)


def _bake_normals(
    bare: tuple[Any, ...], size: int, scan: Mesh | None
) -> UInt8[np.ndarray, "size size 3"]:
    """Bake the scan's normals into the face's texture; flat where the scan is not near."""
    positions, normals, tangents, uv, triangles = bare
    baked = np.zeros((size, size, 3))
    baked[..., 2] = 1
    if scan is not None:
        raster = rasterise(uv[triangles], size)
        inside = raster.triangle >= 0
        corners, weights = triangles[raster.triangle[inside]], raster.barycentric[inside]
        point, normal, along = (
            interpolate(weights, each[corners]) for each in (positions, normals, tangents[:, :3])
        )
        across = np.cross(normal, along) * tangents[corners[:, 0], 3:]
        detail, found = _find_normals(scan, point, normalise(normal))
        frame = np.stack([along, across, normal], 2)
        local = np.linalg.solve(
            frame + 1e-9 * np.eye(3), np.where(found[:, None], detail, normalise(normal))[..., None]
        )[..., 0]
        baked[inside] = normalise(local)
    return np.rint(127.5 * (baked + 1)).astype(np.uint8)


def _find_normals(
    scan: Mesh, points: Float[np.ndarray, "points 3"], normals: Float[np.ndarray, "points 3"]
) -> tuple[Float[np.ndarray, "points 3"], Any]:
    """Find the scan's normals at its closest points, and which of them can be used."""
    closest = TriangleTree(scan.vertices, scan.triangles).query(points, _LIMIT)
    corners = scan.triangles[closest.triangle]
    smooth = compute_vertex_normals(scan.vertices, scan.triangles)
    detail = normalise(interpolate(closest.barycentric, smooth[corners]))
    agrees = np.einsum("px,px->p", detail, normals) >= np.cos(np.deg2rad(_MAX_ANGLE))
    return detail, (closest.triangle >= 0) & agrees
