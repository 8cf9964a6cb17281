"""A shape model fitted to a scan: landmarks, then trimmed iterative closest points."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np
from jaxtyping import Bool, Float

from skinnet.errors import InputError
from skinnet.mesh.mesh import Mesh
from skinnet.shape._icp import Stage
from skinnet.shape._moments import gather
from skinnet.shape._scan_points import ScanPoints
from skinnet.shape._separable import Separable, solve
from skinnet.shape.fit_settings import FitSettings, StageRecord
from skinnet.shape.model import ShapeModel
from skinnet.shape.similarity import Similarity, fit_similarity

LANDMARK_NOISE = 2.0
"""Standard deviation in mm that landmarks are taken to have when they start a fit."""

LANDMARK_MODES = 20


@dataclass(frozen=True)
class Registration:
    """A fitted model.

    `vertices` [N, 3] in the scan's frame and unit are pose(model.reconstruct(alpha)). `distances` [N] in
    mm are those to the scan's surface, `kept` [N] the vertices that the last step fitted.
    `millimetres` is the length of the scan's unit as the fit's scale has it.
    """

    pose: Similarity
    alpha: Float[np.ndarray, "modes"]
    vertices: Float[np.ndarray, "vertices 3"]
    distances: Float[np.ndarray, "vertices"]
    kept: Bool[np.ndarray, "vertices"]
    millimetres: float
    record: tuple[StageRecord, ...] = field(default=())

    @property
    def converged(self) -> bool:
        """Whether the last stage met its stopping rule before its iterations ran out."""
        return self.record[-1].converged

    @property
    def rms(self) -> float:
        """Root mean square distance of the kept vertices in mm."""
        return float(np.sqrt(np.mean(self.distances[self.kept] ** 2)))


Progress = Callable[[str], None]


def register(
    model: ShapeModel,
    scan: Mesh,
    landmarks: Mapping[str, Float[np.ndarray, "3"]] | None = None,
    settings: FitSettings | None = None,
    progress: Progress | None = None,
    start: Similarity | None = None,
) -> Registration:
    """Fit `model` to `scan`, begun from the landmarks that both have, or from a pose `start`.

    Matches are the nearest points of the scan to the model's vertices; those on the scan's open
    edge are dropped, and of all vertices the share `kept` with the closest matches is fitted.
    `progress` is called with a line for every stage. Without landmarks,
    `skinnet.pipeline.find_initial_pose` finds a start. Raises `InputError` without either, and
    where the scan and the model do not meet.
    """
    settings = settings or FitSettings()
    pose, alpha = _begin(model, scan, landmarks, settings, start)
    surface = ScanPoints(scan)
    records = []
    for vertices, modes, prior in settings.stages:
        stage = Stage(model, surface, settings, alpha, vertices, modes, prior)
        try:
            pose, alpha, record = stage.run(pose, alpha)
        except InputError as error:
            raise InputError(f"{scan.name}: {error}") from error
        records.append(record)
        if progress is not None:
            progress(
                f"{scan.name}: {record.vertices} vertices, {record.modes} modes, "
                f"{len(record.rms)} steps, {record.rms[-1]:.3f} mm"
            )
    return _finished(model, surface, settings, pose, alpha, tuple(records))


def _begin(
    model: ShapeModel,
    scan: Mesh,
    landmarks: Mapping[str, Float[np.ndarray, "3"]] | None,
    settings: FitSettings,
    start: Similarity | None,
) -> tuple[Similarity, Float[np.ndarray, "modes"]]:
    if landmarks is not None:
        return from_landmarks(model, landmarks, settings.map_weight)
    if start is None:
        raise InputError(
            f"{scan.name} comes without landmarks and without a start; give one of the two. "
            "skinnet.pipeline.find_initial_pose finds the pose of an upright face."
        )
    return start, np.zeros(1)


def from_landmarks(
    model: ShapeModel, landmarks: Mapping[str, Float[np.ndarray, "3"]], map_weight: float = 0.0
) -> tuple[Similarity, Float[np.ndarray, "modes"]]:
    """Pose and first coefficients from named points alone, held by a prior at 2 mm of noise."""
    names = sorted(set(landmarks) & set(model.landmarks))
    if len(names) < 4:
        raise InputError(
            f"{len(names)} of the scan's landmarks are known to {model.name}; four are needed, of "
            f"{', '.join(sorted(model.landmarks)) or 'none: the model has no landmarks'}."
        )
    vertices = [model.landmarks[name] for name in names]
    points = np.stack([landmarks[name] for name in names]).astype(np.float64)
    start = fit_similarity(model.mean[vertices].astype(np.float64), points)
    modes = min(LANDMARK_MODES, len(model.basis))
    basis = model.basis[:modes, vertices].astype(np.float64)
    moments = gather(basis, model.mean[vertices].astype(np.float64), points)
    noise = LANDMARK_NOISE * start.scale / model.millimetres
    weight = max(noise, np.sqrt(map_weight) * start.scale / model.millimetres) ** 2
    found = solve(Separable(moments, model.variances[:modes].astype(np.float64), weight), start)
    return found.pose, found.alpha


def _finished(
    model: ShapeModel,
    surface: ScanPoints,
    settings: FitSettings,
    pose: Similarity,
    alpha: Float[np.ndarray, "modes"],
    records: tuple[StageRecord, ...],
) -> Registration:
    stage = Stage(model, surface, settings, alpha, 0, len(alpha))
    vertices = pose(stage.shape(alpha))
    match, kept, _ = stage.matches(vertices, pose)
    millimetres = model.millimetres / pose.scale
    return Registration(
        pose, alpha, vertices, match.across(vertices) * millimetres, kept, millimetres, records
    )
