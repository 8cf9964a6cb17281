"""The separable fit: what an evaluation and a whole fit cost, and how often a face is recovered.

`python -m benchmarks.fit [--json]`. The model has the size of the Basel Face Model, 53,490 vertices
and 199 modes: the procedural face, its own variation, and smooth random fields. `eval_ms` has a
prior, so every pose is solved anew; `eval_free_ms` is the paper's form, whose elimination is done
once. Both are set beside building A of equation 6 and solving it. Times are the least of several.
"""

import json
import resource
import subprocess
import sys
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np
import torch
import trimesh
from scipy.ndimage import zoom
from scipy.spatial.transform import Rotation

from benchmarks.report import Results, main
from skinnet.mesh import Mesh
from skinnet.shape._moments import compute_moments
from skinnet.shape._scan_points import ScanPoints
from skinnet.shape._separable import SeparableObjective
from skinnet.shape.model import ShapeModel
from skinnet.shape.procedural_head import IDENTITY_SIZE, compute_chart_angles, compute_head_radius
from skinnet.shape.registration import Registration, register
from skinnet.shape.similarity import Similarity, fit_similarity

VERTICES, MODES = 53_490, 199
TARGET = 100_000
FACES, FACE_VERTICES = 100, 8_000
RIVAL_VERTICES = 2_000
HEIGHT = 180.0
FACE = (1.45, 1.15)
"""Largest azimuth and elevation of the chart that count as face, in radians."""

MARKS = 20


@cache
def big_model(vertices: int = VERTICES, modes: int = MODES, seed: int = 0) -> ShapeModel:
    """A face of that many vertices, 180 mm tall, with that many modes."""
    side = int(np.ceil(np.sqrt(vertices)))
    draw = np.random.default_rng(seed)
    people = 2 * modes
    identity = np.concatenate(
        [np.zeros((1, IDENTITY_SIZE)), draw.normal(size=(people, IDENTITY_SIZE))]
    )
    heads = _heads(identity, side)
    heads *= HEIGHT / np.ptp(heads[0, ..., 1])
    for row in range(people):
        heads[row + 1] += _field(draw, side)
    flat = heads.reshape(people + 1, -1, 3)[:, :vertices]
    mean, moved = flat[0], (flat[1:] - flat[1:].mean(0)).reshape(people, -1)
    values, vectors = np.linalg.eigh(moved @ moved.T)
    values, vectors = values[::-1][:modes], vectors[:, ::-1][:, :modes]
    basis = (vectors / np.sqrt(values)).T @ moved
    return ShapeModel(
        mean.astype(np.float32),
        basis.reshape(modes, vertices, 3).astype(np.float32),
        values / (people - 1),
        _grid(side, vertices),
        landmarks=_marks(mean),
        name="the benchmark's model",
    )


def _heads(identity: np.ndarray, side: int) -> np.ndarray:
    """Heads over the face's part of the chart, [people, side, side, 3]."""
    rows, columns = (
        int(np.ceil(1.01 * side * full / part))
        for part, full in zip(FACE[::-1], (1.5, 2.0), strict=True)
    )
    azimuth, elevation = (axis.numpy().ravel() for axis in compute_chart_angles(rows, columns))
    first_row, first_column = (rows - side) // 2, (columns - side) // 2
    inside = slice(first_row, first_row + side), slice(first_column, first_column + side)
    radius = np.concatenate(
        [
            compute_head_radius(torch.from_numpy(one[None]).float(), rows, columns)[:, 0][
                (..., *inside)
            ].numpy()
            for one in identity
        ]
    )
    elevation, azimuth = elevation[inside[0], None], azimuth[None, inside[1]]
    x, y = np.cos(elevation) * np.sin(azimuth), np.sin(elevation) + 0 * azimuth
    direction = np.stack([x, y, np.cos(elevation) * np.cos(azimuth)], -1)
    return radius[..., None] * direction


def _field(draw: np.random.Generator, side: int) -> np.ndarray:
    """A smooth displacement of about a millimetre [side, side, 3]."""
    total = np.zeros((side, side, 3))
    for knots, size in ((5, 0.8), (12, 0.4)):
        coarse = size * draw.normal(size=(knots, knots, 3))
        total += zoom(
            coarse, (side / knots, side / knots, 1), order=2, grid_mode=True, mode="nearest"
        )
    return total


def _grid(side: int, vertices: int) -> np.ndarray:
    """Triangles between neighbours of a grid, of which only the first vertices exist."""
    index = np.arange(side * side).reshape(side, side)
    a, b, c, d = index[:-1, :-1], index[1:, :-1], index[1:, 1:], index[:-1, 1:]
    halves = [np.stack([a, b, c], -1), np.stack([a, c, d], -1)]
    triangles = np.concatenate([half.reshape(-1, 3) for half in halves])
    return triangles[(triangles < vertices).all(1)]


def _marks(mean: np.ndarray) -> dict[str, int]:
    """Vertices far from one another, begun at the tip of the nose."""
    chosen = [int(mean[:, 2].argmax())]
    while len(chosen) < MARKS:
        far = np.min([np.linalg.norm(mean - mean[one], axis=1) for one in chosen], 0)
        chosen.append(int(np.where(mean[:, 2] > np.median(mean[:, 2]), far, 0).argmax()))
    return {f"mark_{number}": vertex for number, vertex in enumerate(chosen)}


@dataclass(frozen=True)
class Case:
    """A scan made from the model: what a fit is given, and the truth in mm."""

    scan: Mesh
    landmarks: Mapping[str, np.ndarray]
    pose: Similarity
    truth: np.ndarray
    present: np.ndarray

    def error(self, found: Registration, triangles: np.ndarray) -> tuple[float, float]:
        """RMS distance in mm of the surface that was present to the fitted surface, and of the
        fitted vertices to their own true places there."""
        fitted = self.pose.apply_inverse(found.vertices)
        there = ScanPoints(Mesh(fitted, triangles))
        across = there.find_nearest(self.truth[self.present]).measure_distance(
            self.truth[self.present]
        )
        apart = np.linalg.norm(fitted - self.truth, axis=1)[self.present]
        return float(np.sqrt(np.mean(across**2))), float(np.sqrt(np.mean(apart**2)))


def case(
    model: ShapeModel, seed: int, missing: float = 0.2, outliers: float = 0.01, noise: float = 2.0
) -> Case:
    """A random face turned by up to 30 degrees, of any size and place.

    A patch of it is missing, some vertices are 20 mm off (standard deviation, each axis), and
    landmarks are `noise` mm off. The scan has other vertices than the model: the middles of its
    triangles, joined anew.
    """
    draw = np.random.default_rng(seed)
    truth = model.reconstruct(draw.normal(size=len(model.variances)) * np.sqrt(model.variances))
    axis = draw.normal(size=3)
    turn = np.radians(30 * draw.random()) * axis / np.linalg.norm(axis)
    scale, place = float(np.exp(draw.normal(0, 1))), 300 * draw.normal(size=3)
    pose = Similarity(Rotation.from_rotvec(turn).as_matrix(), scale, place)
    middle = truth[draw.integers(len(truth))]
    distance = np.linalg.norm(truth - middle, axis=1)
    present = distance >= np.quantile(distance, missing) if missing else distance >= 0
    points, triangles = _remeshed(truth, model.triangles[present[model.triangles].all(1)])
    wrong = draw.random(len(points)) < outliers
    points[wrong] += 20 * draw.normal(size=(wrong.sum(), 3))
    marks = {
        name: pose(truth[vertex] + noise * draw.normal(size=3))
        for name, vertex in model.landmarks.items()
    }
    return Case(Mesh(pose(points), triangles, name="a made scan"), marks, pose, truth, present)


def _remeshed(vertices: np.ndarray, triangles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The same surface with its edges' middles as further vertices, pushed off the model's own."""
    points, finer = trimesh.remesh.subdivide(vertices, triangles)
    used, index = np.unique(finer, return_inverse=True)
    return points[used], index.reshape(-1, 3)


def recovery(faces: int = FACES, vertices: int = FACE_VERTICES, modes: int = MODES) -> Results:
    """How many of the faces end within 1 mm RMS of the surface that was present."""
    model = big_model(vertices, modes)
    found = [
        (one := case(model, seed)).error(register(model, one.scan, one.landmarks), model.triangles)
        for seed in range(faces)
    ]
    errors, apart = np.array(found).T
    return {
        "share_within_1mm": float(np.mean(errors <= 1)),
        "faces": faces,
        "vertices": vertices,
        "median_mm": float(np.median(errors)),
        "worst_mm": float(errors.max()),
        "median_vertex_mm": float(np.median(apart)),
        "share_of_vertices_within_1mm": float(np.mean(apart <= 1)),
    }


def evaluations(vertices: int = VERTICES, modes: int = MODES, repeats: int = 50) -> Results:
    """One residual-and-gradient evaluation beside building A and solving it, in one process."""
    model = big_model(vertices, modes)
    one = case(model, 0, missing=0)
    points = one.pose(one.truth)
    start = time.perf_counter()
    moments = compute_moments(model.basis, model.mean.astype(np.float64), points)
    gathered = time.perf_counter() - start
    turn, scale = Rotation.from_rotvec([0.1, 0.2, 0.3]).as_matrix(), one.pose.scale
    with_prior, free = (
        SeparableObjective(moments, model.variances, weight) for weight in (1e-6, 0.0)
    )
    free(turn, scale)
    seconds = {
        "eval": least(lambda: with_prior(turn, scale), repeats),
        "eval_free": least(lambda: free(turn, scale), repeats),
        "lstsq": least(lambda: plain(model, points, turn, scale), 2),
    }
    alpha, value = plain(model, points, turn, scale)
    ours = free(turn, scale)
    return {
        "eval_ms": 1e3 * seconds["eval"],
        "eval_free_ms": 1e3 * seconds["eval_free"],
        "speedup_vs_lstsq": seconds["lstsq"] / seconds["eval"],
        "gather_ms": 1e3 * gathered,
        "speedup_with_gather": seconds["lstsq"] / (seconds["eval"] + gathered),
        "lstsq_s": seconds["lstsq"],
        "difference": abs(ours.value - value) / value,
        "alpha_difference": float(np.abs(ours.alpha - alpha).max() / np.abs(alpha).max()),
    }


def plain(
    model: ShapeModel, points: np.ndarray, turn: np.ndarray, scale: float
) -> tuple[np.ndarray, float]:
    """Alpha and objective of equation 6, A built and solved by the normal equations."""
    count, modes = len(points), len(model.basis)
    a = np.zeros((3 * count, modes + 3))
    a[:, :modes] = (scale * model.basis.astype(np.float64) @ turn.T).reshape(modes, -1).T
    a[:, modes:] = np.tile(np.eye(3), (count, 1))
    y = (points - scale * model.mean.astype(np.float64) @ turn.T).ravel()
    solution, squared, *_ = np.linalg.lstsq(a, y, rcond=None)
    return solution[:modes], float(squared[0])


def least(action: Callable[[], object], repeats: int) -> float:
    """The least time of an action, in seconds."""
    times = []
    for _ in range(repeats):
        start = time.perf_counter()
        action()
        times.append(time.perf_counter() - start)
    return min(times)


def whole_fit(vertices: int = VERTICES, modes: int = MODES, target: int = TARGET) -> Results:
    """The trimmed fit of the whole model to a scan of about `target` vertices."""
    model = big_model(vertices, modes)
    one = _thinned(case(model, 1), target)
    seconds, found = np.inf, None
    for _ in range(3):
        start = time.perf_counter()
        found = register(model, one.scan, one.landmarks)
        seconds = min(seconds, time.perf_counter() - start)
    error, apart = one.error(found, model.triangles)
    return {
        "fit_s": seconds,
        "target_vertices": len(one.scan.vertices),
        "steps": [len(stage.rms) for stage in found.record],
        "error_mm": error,
        "vertex_error_mm": apart,
        "peak_gb": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**20,
    }


def _thinned(one: Case, target: int) -> Case:
    """The scan with its rearmost triangles cut off until about `target` vertices are left."""
    ahead = one.pose.apply_inverse(one.scan.vertices)[:, 2]
    cut = np.sort(ahead)[max(len(ahead) - target, 0)]
    triangles = one.scan.triangles[(ahead >= cut)[one.scan.triangles].all(1)]
    used, index = np.unique(triangles, return_inverse=True)
    scan = Mesh(one.scan.vertices[used], index.reshape(-1, 3), name=one.scan.name)
    gone = one.pose.apply_inverse(scan.vertices)[:, 2].min()
    return Case(scan, one.landmarks, one.pose, one.truth, one.present & (one.truth[:, 2] > gone))


def beside_nricp(vertices: int = RIVAL_VERTICES, modes: int = 60) -> Results:
    """The same pair fitted by us and by trimesh's nricp_amberg, at a size that it can finish.

    It is given the scan in the model's frame by the landmarks' similarity, as its users would.
    """
    model = big_model(vertices, modes)
    one = case(model, 2)
    start = time.perf_counter()
    ours = one.error(register(model, one.scan, one.landmarks), model.triangles)
    seconds = time.perf_counter() - start
    names = sorted(model.landmarks)
    marks = np.stack([one.landmarks[name] for name in names])
    rows = [model.landmarks[name] for name in names]
    pose = fit_similarity(model.mean[rows].astype(np.float64), marks)
    source = trimesh.Trimesh(model.mean, model.triangles, process=False)
    target = trimesh.Trimesh(
        pose.apply_inverse(one.scan.vertices), one.scan.triangles, process=False
    )
    start = time.perf_counter()
    moved = trimesh.registration.nricp_amberg(
        source, target, rows, pose.apply_inverse(marks), use_faces=False
    )
    rival = time.perf_counter() - start
    found = Registration(pose, np.zeros(0), pose(moved), np.zeros(0), np.zeros(0, bool), 1.0, ())
    theirs = one.error(found, model.triangles)
    return {
        "vertices": vertices,
        "speedup": rival / seconds,
        "ours_s": seconds,
        "nricp_s": rival,
        "ours_mm": ours[0],
        "nricp_mm": theirs[0],
        "ours_vertex_mm": ours[1],
        "nricp_vertex_mm": theirs[1],
    }


def in_own_process(expression: str) -> Results:
    """A measurement in a process of its own, whose peak of memory is nobody else's."""
    code = f"import json; from benchmarks.fit import *; print(json.dumps({expression}))"
    root = Path(__file__).parents[1]
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=root, capture_output=True, text=True, check=True
    )
    found: Results = json.loads(done.stdout)
    return found


def measure() -> Results:
    """Every figure, by name."""
    fit = in_own_process("whole_fit()")
    return {
        **evaluations(),
        "fit_s": fit.pop("fit_s"),
        "peak_gb": fit.pop("peak_gb"),
        "recovery": (found := recovery())["share_within_1mm"],
        "fit": fit,
        "recovery_detail": found,
        "beside_nricp": beside_nricp(),
    }


if __name__ == "__main__":
    main(measure, "The separable fit beside a plain solver and trimesh's non-rigid registration.")
