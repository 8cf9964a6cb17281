"""Time and accuracy of the texture space: embedding, raster, warp, closest points.

`python -m benchmarks.texture [--json]`. A mesh of 53,490 vertices and 106,000 triangles in the
shape of a face, with holes for eyes and mouth and quads that are all split the same way, is
embedded, and a picture is warped into it at 1024 x 1024. The warp is compared with scikit-image's
piecewise affine warp on a mesh small enough for it, closest points and repair of orientation with
trimesh's on a surface with triangles of very different sizes. Times are the least of several runs
in one process.
"""

import time
from collections.abc import Callable
from typing import Any

import numpy as np
from jaxtyping import Float, Int
from scipy.spatial import Delaunay, cKDTree
from skimage.transform import PiecewiseAffineTransform, warp
from trimesh import Trimesh
from trimesh.repair import fix_normals
from trimesh.triangles import closest_point

from benchmarks.report import Results, main
from skinnet.mesh import Mesh, TriangleTree, rasterise, repair_mesh
from skinnet.mesh._orientation import is_inside_out
from skinnet.texture._flips import count_flipped_triangles
from skinnet.texture._mirror import find_mirror_vertices
from skinnet.texture.tutte import compute_tutte_embedding
from skinnet.texture.warp import TextureSpace, warp_texture

VERTICES = 53_490
SIZE = 1024
RUNS = 5
POINTS, SMALL = 100, 256
"""Points and side of the picture for scikit-image, which takes 16 s for 400 at 1024 x 1024."""

UNEVEN = 8000
"""Vertices of the surface with triangles of different sizes, about as many as a scan has."""

QUERIES = 5000
"""Points near that surface whose closest points on it are looked for."""

HOLES = ((-0.4, 0.25, 0.16, 0.06), (0.4, 0.25, 0.16, 0.06), (0.0, -0.45, 0.22, 0.04))
"""Centre and half axes of eyes and mouth, in half widths and half heights of the mesh."""


def make_face_mesh(
    columns: int, rows: int
) -> tuple[Float[np.ndarray, "vertices 3"], Int[np.ndarray, "triangles 3"]]:
    """Make a curved patch with a nose and `HOLES`, symmetric except for the quads' diagonals."""
    y, x = np.meshgrid(np.linspace(1, -1, rows), np.linspace(-1, 1, columns), indexing="ij")
    z = np.sqrt(2.5 - x**2 - y**2) + 0.35 * np.exp(-(x**2) / 0.02 - y**2 / 0.06)
    vertices = np.stack([80 * x, 110 * y, 90 * z], -1).reshape(-1, 3)
    number = np.arange(rows * columns).reshape(rows, columns)
    a, b, c, d = number[1:, :-1], number[1:, 1:], number[:-1, 1:], number[:-1, :-1]
    quads = np.stack([a, b, c, d], -1).reshape(-1, 4)
    middle = vertices[quads].mean(1) / [80, 110, 1]
    for u, v, width, height in HOLES:
        out = ((middle[:, 0] - u) / width) ** 2 + ((middle[:, 1] - v) / height) ** 2 > 1
        quads, middle = quads[out], middle[out]
    used = np.unique(quads)
    quads = np.searchsorted(used, quads)
    return vertices[used], np.concatenate([quads[:, :3], quads[:, [0, 2, 3]]])


def scatter_points(
    points: int, size: int, seed: int = 0
) -> tuple[Float[np.ndarray, "points 2"], Float[np.ndarray, "points 2"]]:
    """Sample places (x, y) in a square picture, near its corners too, and nearby source places."""
    rng = np.random.default_rng(seed)
    inner = rng.uniform(0.05, 0.95, (points - 4, 2))
    places = np.concatenate([[[0.02, 0.01], [0.98, 0.03], [0.99, 0.97], [0.01, 0.98]], inner])
    moved = places + 0.03 * np.sin(5 * places[:, ::-1])
    return places * (size - 1), moved.clip(0, 1) * (size - 1)


def warp_with_skimage(
    places: Float[np.ndarray, "points 2"],
    source: Float[np.ndarray, "points 2"],
    picture: Float[np.ndarray, "size size 3"],
) -> Float[np.ndarray, "size size 3"]:
    """Warp a picture with scikit-image so that its points at `source` come to `places`."""
    transform = PiecewiseAffineTransform.from_estimate(places, source)
    warped: Float[np.ndarray, "size size 3"] = warp(picture, transform, order=1, mode="edge")
    return warped


def warp_with_skinnet(
    places: Float[np.ndarray, "points 2"],
    source: Float[np.ndarray, "points 2"],
    picture: Float[np.ndarray, "size size 3"],
) -> tuple[Float[np.ndarray, "size size 3"], Any]:
    """Warp the same with the same triangles and one sample per texel."""
    size = len(picture)
    triangles = Delaunay(places).simplices.astype(np.int64)
    flip = np.array([1, -1]), np.array([0.5, size - 0.5])
    uv, coordinates = ((pixels * flip[0] + flip[1]) / size for pixels in (places, source))
    space = TextureSpace(uv, triangles, size)
    everywhere = np.ones(len(triangles), bool)
    return warp_texture(space, coordinates[triangles], everywhere, picture, max_samples=1)


def compare_with_skimage(points: int, size: int) -> Results:
    """Compare with scikit-image: largest difference inside the mesh, and ratio of times."""
    places, source = scatter_points(points, size)
    picture = np.random.default_rng(1).random((size, size, 3))
    ours_s, (image, mask) = time_runs(lambda: warp_with_skinnet(places, source, picture))
    theirs_s, theirs = time_runs(lambda: warp_with_skimage(places, source, picture), runs=2)
    return {
        "warp_vs_skimage_max_difference": float(np.abs(image - theirs)[mask].max()),
        "warp_vs_skimage_speedup": theirs_s / ours_s,
    }


def make_uneven_mesh(
    count: int, seed: int = 0
) -> tuple[Float[np.ndarray, "vertices 3"], Int[np.ndarray, "triangles 3"]]:
    """Make a curved patch that faces +z, of size 2, with small triangles in the middle."""
    place = np.random.default_rng(seed).uniform(-1, 1, (count, 2)) ** 3
    vertices = np.column_stack([place, np.sqrt(2.5 - (place**2).sum(1))])
    triangles = Delaunay(place).simplices.astype(np.int64)
    repaired = repair_mesh(Mesh(vertices, triangles)).mesh
    return repaired.vertices, repaired.triangles


def compare_with_trimesh(count: int, queries: int) -> Results:
    """Compare closest points, exact and by centroids, and orientation when faces are flipped."""
    vertices, triangles = make_uneven_mesh(count)
    rng = np.random.default_rng(1)
    points = vertices[rng.integers(0, len(vertices), queries)] + rng.normal(0, 0.02, (queries, 3))
    corners = vertices[triangles]

    def measure_by_centroids() -> Float[np.ndarray, "queries"]:
        nearest = cKDTree(corners.mean(1)).query(points, 8)[1]
        repeated = np.repeat(points, 8, 0)
        away = closest_point(corners[nearest.ravel()], repeated) - repeated
        return np.asarray(np.linalg.norm(away, axis=1).reshape(-1, 8).min(1))

    flipped = np.where(rng.random((len(triangles), 1)) < 0.3, triangles[:, ::-1], triangles)

    def orient_with_trimesh(
        faces: Int[np.ndarray, "triangles 3"],
    ) -> Int[np.ndarray, "triangles 3"]:
        mesh = Trimesh(vertices, faces, process=False)
        fix_normals(mesh, multibody=False)
        return np.asarray(mesh.faces)

    closest_s, closest = time_runs(lambda: TriangleTree(vertices, triangles).query(points))
    centroid_s, distance = time_runs(measure_by_centroids)
    repair_s, _ = time_runs(lambda: repair_mesh(Mesh(vertices, flipped)))
    trimesh_s, _ = time_runs(lambda: orient_with_trimesh(flipped), runs=2)
    return {
        "closest_s": closest_s,
        "closest_centroid_s": centroid_s,
        "closest_centroid_error": float((distance - closest.distance).max()) / 2,
        "repair_s": repair_s,
        "repair_vs_trimesh_speedup": trimesh_s / repair_s,
        "trimesh_inside_out": is_inside_out(vertices, orient_with_trimesh(triangles[:, ::-1])),
    }


def time_runs(action: Callable[[], Any], runs: int = RUNS) -> tuple[float, Any]:
    """Measure the least time of several runs in seconds, and return it with the last result."""
    times = []
    for _ in range(runs):
        start = time.perf_counter()
        result = action()
        times.append(time.perf_counter() - start)
    return min(times), result


def measure(
    vertices: int = VERTICES,
    size: int = SIZE,
    points: int = POINTS,
    small: int = SMALL,
    uneven: int = UNEVEN,
) -> Results:
    """Measure every figure, by name."""
    rows = int(np.ceil(np.sqrt(vertices * 1.02)))
    surface, triangles = make_face_mesh(rows, rows)
    mirror_s, mirror = time_runs(lambda: find_mirror_vertices(surface))
    tutte_s, uv = time_runs(lambda: compute_tutte_embedding(surface, triangles, mirror))
    raster_s, _ = time_runs(lambda: rasterise(uv[triangles], size))
    source = 0.5 + surface[:, :2] / [170, 230]
    picture = np.random.default_rng(0).random((size, size, 3), np.float32)
    everywhere = np.ones(len(triangles), bool)

    def warp_picture() -> Any:
        space = TextureSpace(uv, triangles, size)
        return warp_texture(space, source[triangles], everywhere, picture)

    return {
        "vertices": len(surface),
        "triangles": len(triangles),
        "mirror_s": mirror_s,
        "tutte_s": tutte_s,
        "flipped": count_flipped_triangles(uv, triangles),
        "asymmetry": float(np.abs(uv[mirror] - [1, 0] - uv * [-1, 1]).max()),
        "raster_s": raster_s,
        "warp_s": time_runs(warp_picture)[0],
        **compare_with_skimage(points, small),
        **compare_with_trimesh(uneven, QUERIES),
    }


if __name__ == "__main__":
    main(measure, "A texture space: embedding, raster and warp.")
