"""The separable fit: time of an evaluation and of a whole fit, and share of faces recovered.

`python -m benchmarks.fit [--json]`. The model has the size of the Basel Face Model, 53,490 vertices
and 199 modes: the procedural face with its own variation and smooth random fields. `eval_ms` has a
prior, which needs a new elimination at every pose; `eval_free_ms` is the paper's form, whose
elimination is computed once. Both are compared with building A of Equation 6 of Alotaibi & Smith
2017 and solving it. Times are the least of several runs.
"""

import json
import resource
import subprocess
import sys
import time
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np
import torch
import trimesh
from scipy.ndimage import zoom
from scipy.spatial.transform import Rotation

from benchmarks.report import Results, main
from benchmarks.resources import time_least
from skinnet.mesh import Mesh
from skinnet.shape._moments import compute_moments
from skinnet.shape._procedural_head import IDENTITY_SIZE, compute_chart_angles, compute_head_radius
from skinnet.shape._scan_points import ScanPoints
from skinnet.shape._separable import SeparableObjective
from skinnet.shape.model import ShapeModel
from skinnet.shape.registration import Registration, register
from skinnet.shape.similarity import Similarity, fit_similarity

VERTICES, MODES = 53_490, 199
TARGET = 100_000
FACES, FACE_VERTICES = 100, 8_000
RIVAL_VERTICES = 2_000
HEIGHT = 180.0
FACE = (1.45, 1.15)
"""Largest azimuth and elevation of the chart that count as face, in radians."""

LANDMARK_COUNT = 20


@cache
def make_big_model(vertices: int = VERTICES, modes: int = MODES, seed: int = 0) -> ShapeModel:
    """Make a face of that many vertices, 180 mm tall, with that many modes."""
    side = int(np.ceil(np.sqrt(vertices)))
    rng = np.random.default_rng(seed)
    people = 2 * modes
    identity = np.concatenate(
        [np.zeros((1, IDENTITY_SIZE)), rng.normal(size=(people, IDENTITY_SIZE))]
    )
    heads = _compute_heads(identity, side)
    heads *= HEIGHT / np.ptp(heads[0, ..., 1])
    for row in range(people):
        heads[row + 1] += _sample_field(rng, side)
    flat = heads.reshape(people + 1, -1, 3)[:, :vertices]
    mean, moved = flat[0], (flat[1:] - flat[1:].mean(0)).reshape(people, -1)
    values, vectors = np.linalg.eigh(moved @ moved.T)
    values, vectors = values[::-1][:modes], vectors[:, ::-1][:, :modes]
    basis = (vectors / np.sqrt(values)).T @ moved
    return ShapeModel(
        mean.astype(np.float32),
        basis.reshape(modes, vertices, 3).astype(np.float32),
        values / (people - 1),
        _make_grid(side, vertices),
        landmarks=_place_landmarks(mean),
        name="the benchmark's model",
    )


def _compute_heads(identity: np.ndarray, side: int) -> np.ndarray:
    """Compute heads over the face's part of the chart, [people, side, side, 3]."""
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


def _sample_field(rng: np.random.Generator, side: int) -> np.ndarray:
    """Sample a smooth displacement of about a millimetre, [side, side, 3]."""
    total = np.zeros((side, side, 3))
    for knots, size in ((5, 0.8), (12, 0.4)):
        coarse = size * rng.normal(size=(knots, knots, 3))
        total += zoom(
            coarse, (side / knots, side / knots, 1), order=2, grid_mode=True, mode="nearest"
        )
    return total


def _make_grid(side: int, vertices: int) -> np.ndarray:
    """Make triangles between neighbours of a grid, of which only the first vertices exist."""
    index = np.arange(side * side).reshape(side, side)
    a, b, c, d = index[:-1, :-1], index[1:, :-1], index[1:, 1:], index[:-1, 1:]
    halves = [np.stack([a, b, c], -1), np.stack([a, c, d], -1)]
    triangles = np.concatenate([half.reshape(-1, 3) for half in halves])
    return triangles[(triangles < vertices).all(1)]


def _place_landmarks(mean: np.ndarray) -> dict[str, int]:
    """Choose vertices far from each other, first the tip of the nose."""
    chosen = [int(mean[:, 2].argmax())]
    while len(chosen) < LANDMARK_COUNT:
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

    def measure_error(self, found: Registration, triangles: np.ndarray) -> tuple[float, float]:
        """Measure RMS distances in mm where the scan is complete.

        The first is from the true to the fitted surface, the second from the fitted vertices to
        their own true places.
        """
        fitted = self.pose.apply_inverse(found.vertices)
        there = ScanPoints(Mesh(fitted, triangles))
        across = there.find_nearest(self.truth[self.present]).measure_distance(
            self.truth[self.present]
        )
        apart = np.linalg.norm(fitted - self.truth, axis=1)[self.present]
        return float(np.sqrt(np.mean(across**2))), float(np.sqrt(np.mean(apart**2)))


def make_case(
    model: ShapeModel, seed: int, missing: float = 0.2, outliers: float = 0.01, noise: float = 2.0
) -> Case:
    """Make a scan of a random face, rotated by up to 30 degrees, at any scale and place.

    A patch is missing, some vertices have noise of 20 mm and landmarks of `noise` mm (standard
    deviation along each axis). The scan has more vertices than the model: the middles of edges too.
    """
    rng = np.random.default_rng(seed)
    truth = model.reconstruct(rng.normal(size=len(model.variances)) * np.sqrt(model.variances))
    axis = rng.normal(size=3)
    rotation = np.radians(30 * rng.random()) * axis / np.linalg.norm(axis)
    scale, place = float(np.exp(rng.normal(0, 1))), 300 * rng.normal(size=3)
    pose = Similarity(Rotation.from_rotvec(rotation).as_matrix(), scale, place)
    middle = truth[rng.integers(len(truth))]
    distance = np.linalg.norm(truth - middle, axis=1)
    present = distance >= np.quantile(distance, missing) if missing else distance >= 0
    points, triangles = _remesh(truth, model.triangles[present[model.triangles].all(1)])
    wrong = rng.random(len(points)) < outliers
    points[wrong] += 20 * rng.normal(size=(wrong.sum(), 3))
    landmarks = {
        name: pose(truth[vertex] + noise * rng.normal(size=3))
        for name, vertex in model.landmarks.items()
    }
    return Case(Mesh(pose(points), triangles, name="a made scan"), landmarks, pose, truth, present)


def _remesh(vertices: np.ndarray, triangles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Add the middles of edges as vertices, and remove unused vertices."""
    points, finer = trimesh.remesh.subdivide(vertices, triangles)
    used, index = np.unique(finer, return_inverse=True)
    return points[used], index.reshape(-1, 3)


def measure_recovery(
    faces: int = FACES, vertices: int = FACE_VERTICES, modes: int = MODES
) -> Results:
    """Measure the share of faces that are fitted to within 1 mm RMS of the true surface."""
    model = make_big_model(vertices, modes)
    found = [
        (one := make_case(model, seed)).measure_error(
            register(model, one.scan, one.landmarks), model.triangles
        )
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


def measure_evaluation(vertices: int = VERTICES, modes: int = MODES, repeats: int = 50) -> Results:
    """Compare one evaluation of Equation 8 with building A of Equation 6 and solving it."""
    model = make_big_model(vertices, modes)
    one = make_case(model, 0, missing=0)
    points = one.pose(one.truth)
    start = time.perf_counter()
    moments = compute_moments(model.basis, model.mean.astype(np.float64), points)
    moments_s = time.perf_counter() - start
    rotation, scale = Rotation.from_rotvec([0.1, 0.2, 0.3]).as_matrix(), one.pose.scale
    with_prior, free = (
        SeparableObjective(moments, model.variances, weight) for weight in (1e-6, 0.0)
    )
    free(rotation, scale)
    seconds = {
        "eval": time_least(lambda: with_prior(rotation, scale), repeats),
        "eval_free": time_least(lambda: free(rotation, scale), repeats),
        "lstsq": time_least(lambda: solve_equation_6(model, points, rotation, scale), 2),
    }
    alpha, value = solve_equation_6(model, points, rotation, scale)
    ours = free(rotation, scale)
    return {
        "eval_ms": 1e3 * seconds["eval"],
        "eval_free_ms": 1e3 * seconds["eval_free"],
        "speedup_vs_lstsq": seconds["lstsq"] / seconds["eval"],
        "gather_ms": 1e3 * moments_s,
        "speedup_with_gather": seconds["lstsq"] / (seconds["eval"] + moments_s),
        "lstsq_s": seconds["lstsq"],
        "difference": abs(ours.value - value) / value,
        "alpha_difference": float(np.abs(ours.alpha - alpha).max() / np.abs(alpha).max()),
    }


def solve_equation_6(
    model: ShapeModel, points: np.ndarray, rotation: np.ndarray, scale: float
) -> tuple[np.ndarray, float]:
    """Solve Equation 6 of Alotaibi & Smith 2017 with the matrix A: alpha and the objective."""
    count, modes = len(points), len(model.basis)
    a = np.zeros((3 * count, modes + 3))
    a[:, :modes] = (scale * model.basis.astype(np.float64) @ rotation.T).reshape(modes, -1).T
    a[:, modes:] = np.tile(np.eye(3), (count, 1))
    y = (points - scale * model.mean.astype(np.float64) @ rotation.T).ravel()
    solution, squared, *_ = np.linalg.lstsq(a, y, rcond=None)
    return solution[:modes], float(squared[0])


def measure_whole_fit(
    vertices: int = VERTICES, modes: int = MODES, target: int = TARGET
) -> Results:
    """Measure the trimmed fit of the whole model to a scan of about `target` vertices."""
    model = make_big_model(vertices, modes)
    one = _crop_case(make_case(model, 1), target)
    seconds, found = np.inf, None
    for _ in range(3):
        start = time.perf_counter()
        found = register(model, one.scan, one.landmarks)
        seconds = min(seconds, time.perf_counter() - start)
    error, apart = one.measure_error(found, model.triangles)
    return {
        "fit_s": seconds,
        "target_vertices": len(one.scan.vertices),
        "steps": [len(stage.rms) for stage in found.record],
        "error_mm": error,
        "vertex_error_mm": apart,
        "peak_gb": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**20,
    }


def _crop_case(one: Case, target: int) -> Case:
    """Cut off the scan's rearmost triangles until about `target` vertices are left."""
    ahead = one.pose.apply_inverse(one.scan.vertices)[:, 2]
    cut = np.sort(ahead)[max(len(ahead) - target, 0)]
    triangles = one.scan.triangles[(ahead >= cut)[one.scan.triangles].all(1)]
    used, index = np.unique(triangles, return_inverse=True)
    scan = Mesh(one.scan.vertices[used], index.reshape(-1, 3), name=one.scan.name)
    gone = one.pose.apply_inverse(scan.vertices)[:, 2].min()
    return Case(scan, one.landmarks, one.pose, one.truth, one.present & (one.truth[:, 2] > gone))


def compare_with_nricp(vertices: int = RIVAL_VERTICES, modes: int = 60) -> Results:
    """Compare with trimesh's nricp_amberg at a size that it can finish.

    It gets the scan in the model's frame, by the similarity transform of the landmarks.
    """
    model = make_big_model(vertices, modes)
    one = make_case(model, 2)
    start = time.perf_counter()
    ours = one.measure_error(register(model, one.scan, one.landmarks), model.triangles)
    seconds = time.perf_counter() - start
    names = sorted(model.landmarks)
    landmarks = np.stack([one.landmarks[name] for name in names])
    rows = [model.landmarks[name] for name in names]
    pose = fit_similarity(model.mean[rows].astype(np.float64), landmarks)
    source = trimesh.Trimesh(model.mean, model.triangles, process=False)
    target = trimesh.Trimesh(
        pose.apply_inverse(one.scan.vertices), one.scan.triangles, process=False
    )
    start = time.perf_counter()
    moved = trimesh.registration.nricp_amberg(
        source, target, rows, pose.apply_inverse(landmarks), use_faces=False
    )
    rival = time.perf_counter() - start
    found = Registration(pose, np.zeros(0), pose(moved), np.zeros(0), np.zeros(0, bool), 1.0, ())
    theirs = one.measure_error(found, model.triangles)
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


def run_in_own_process(expression: str) -> Results:
    """Measure in a separate process, so that its peak memory is its own."""
    code = f"import json; from benchmarks.fit import *; print(json.dumps({expression}))"
    root = Path(__file__).parents[1]
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=root, capture_output=True, text=True, check=True
    )
    found: Results = json.loads(done.stdout)
    return found


def measure() -> Results:
    """Measure every figure, by name."""
    fit = run_in_own_process("measure_whole_fit()")
    return {
        **measure_evaluation(),
        "fit_s": fit.pop("fit_s"),
        "peak_gb": fit.pop("peak_gb"),
        "recovery": (found := measure_recovery())["share_within_1mm"],
        "fit": fit,
        "recovery_detail": found,
        "beside_nricp": compare_with_nricp(),
    }


if __name__ == "__main__":
    main(measure, "The separable fit beside a plain solver and trimesh's non-rigid registration.")
