"""The fit of a shape model to a scan: landmarks, then trimmed ICP."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np
from jaxtyping import Bool, Float

from skinnet.errors import InputError
from skinnet.mesh.mesh import Mesh
from skinnet.shape._icp import IcpStage
from skinnet.shape._landmark_check import MIN_COUNT
from skinnet.shape._moments import compute_moments
from skinnet.shape._scan_points import ScanPoints
from skinnet.shape._separable import SeparableObjective, minimise
from skinnet.shape.fit_settings import FitSettings, StageRecord
from skinnet.shape.model import ShapeModel
from skinnet.shape.similarity import Similarity, fit_similarity

LANDMARK_NOISE = 2.0
"""Assumed standard deviation in mm of the landmarks that start a fit."""

LANDMARK_MODES = 20
"""Modes that landmarks alone determine; section 4.1 uses 20 landmarks."""


@dataclass(frozen=True)
class Registration:
    """The result of a fit.

    Attributes:
        pose: From the model's frame and unit to the scan's.
        alpha: Shape coefficients.
        vertices: The fitted vertices, pose(model.reconstruct(alpha)), in the scan's frame and unit.
        distances: Distance in mm of each vertex to the scan's surface.
        kept: True for the vertices that the last step fitted.
        millimetres: Length of the scan's unit in mm, as the fit's scale implies.
        record: The record of each stage.
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
        """Whether the last stage settled before its iterations ran out."""
        return self.record[-1].converged

    @property
    def rms(self) -> float:
        """Root mean square distance of the kept vertices in mm."""
        return float(np.sqrt(np.mean(self.distances[self.kept] ** 2)))


def register(
    model: ShapeModel,
    scan: Mesh,
    landmarks: Mapping[str, Float[np.ndarray, "3"]] | None = None,
    settings: FitSettings | None = None,
    progress: Callable[[str], None] | None = None,
    start: Similarity | None = None,
) -> Registration:
    """Fit a shape model to a scan by trimmed, non-rigid ICP.

    The fit alternates between two steps: find the nearest points of the scan, and fit pose, scale
    and coefficients to them. Matches on the scan's boundary are dropped, and the share
    `settings.kept` of all vertices, those with the closest matches, is fitted.

    Args:
        model: The shape model.
        scan: The scan, in any frame and unit.
        landmarks: Named points of the scan, at least four of the model's landmarks. They start the
            fit.
        settings: How to fit; None for the defaults.
        progress: A function that is called with one line of text after each stage.
        start: A pose near the solution, used where there are no landmarks.
            `skinnet.pipeline.find_initial_pose` finds the pose of an upright face.

    Returns:
        The fitted pose, coefficients and vertices.

    Raises:
        InputError: If there are neither landmarks nor a start, fewer than four landmarks are those
            of the model, or the fitted model is far from the scan.

    Source:
        Section 4.1 and Equations 5 to 8 of Alotaibi & Smith 2017.

    Example:
        >>> import numpy as np
        >>> from skinnet.shape import FitSettings, load_shape_model, register
        >>> model = load_shape_model(modes=5)
        >>> scan = model.build_mesh(np.array([300.0, 0, 0, 0, 0]))
        >>> landmarks = {name: scan.vertices[i] for name, i in model.landmarks.items()}
        >>> settings = FitSettings(stages=((500, 5, 0.0),), map_weight=0.0)
        >>> float(register(model, scan, landmarks, settings).alpha[0].round())
        300.0
    """
    settings = settings or FitSettings()
    pose, alpha = _begin(model, scan, landmarks, settings, start)
    points = ScanPoints(scan)
    records = []
    for vertices, modes, prior in settings.stages:
        stage = IcpStage(model, points, settings, alpha, vertices, modes, prior)
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
    return _finish(model, points, settings, pose, alpha, tuple(records))


def _begin(
    model: ShapeModel,
    scan: Mesh,
    landmarks: Mapping[str, Float[np.ndarray, "3"]] | None,
    settings: FitSettings,
    start: Similarity | None,
) -> tuple[Similarity, Float[np.ndarray, "modes"]]:
    if landmarks is not None:
        return _fit_to_landmarks(model, landmarks, settings.map_weight)
    if start is None:
        raise InputError(
            f"{scan.name} has neither landmarks nor a start; give one of the two. "
            "skinnet.pipeline.find_initial_pose finds the pose of an upright face."
        )
    return start, np.zeros(1)


def _fit_to_landmarks(
    model: ShapeModel, landmarks: Mapping[str, Float[np.ndarray, "3"]], map_weight: float = 0.0
) -> tuple[Similarity, Float[np.ndarray, "modes"]]:
    """Fit pose and first coefficients to named points alone, with a prior for 2 mm of noise.

    Section 4.1 of Alotaibi & Smith 2017 starts from 20 landmarks.
    """
    names = sorted(set(landmarks) & set(model.landmarks))
    if len(names) < MIN_COUNT:
        raise InputError(
            f"The scan and {model.name} have {len(names)} landmarks in common, and need "
            f"{MIN_COUNT}, of "
            f"{', '.join(sorted(model.landmarks)) or 'none: the model has no landmarks'}."
        )
    vertices = [model.landmarks[name] for name in names]
    points = np.stack([landmarks[name] for name in names]).astype(np.float64)
    start = fit_similarity(model.mean[vertices].astype(np.float64), points)
    modes = min(LANDMARK_MODES, len(model.basis))
    basis = model.basis[:modes, vertices].astype(np.float64)
    moments = compute_moments(basis, model.mean[vertices].astype(np.float64), points)
    noise = LANDMARK_NOISE * start.scale / model.millimetres
    weight = max(noise, np.sqrt(map_weight) * start.scale / model.millimetres) ** 2
    variances = model.variances[:modes].astype(np.float64)
    found = minimise(SeparableObjective(moments, variances, weight), start)
    return found.pose, found.alpha


def _finish(
    model: ShapeModel,
    points: ScanPoints,
    settings: FitSettings,
    pose: Similarity,
    alpha: Float[np.ndarray, "modes"],
    records: tuple[StageRecord, ...],
) -> Registration:
    stage = IcpStage(model, points, settings, alpha, 0, len(alpha))
    vertices = pose(stage.reconstruct(alpha))
    match, kept, _ = stage.match(vertices, pose)
    millimetres = model.millimetres / pose.scale
    distances = match.measure_distance(vertices) * millimetres
    return Registration(pose, alpha, vertices, distances, kept, millimetres, records)
