"""Trimmed, non-rigid ICP: one stage of a fit, on some of the vertices and modes."""

import numpy as np
from jaxtyping import Bool, Float

from skinnet.errors import InputError
from skinnet.mesh._normals import compute_vertex_normals
from skinnet.shape._moments import compute_moments
from skinnet.shape._scan_points import NearestPoints, ScanPoints
from skinnet.shape._separable import SeparableObjective, Solution, minimise
from skinnet.shape.fit_settings import FitSettings, StageRecord
from skinnet.shape.model import ShapeModel
from skinnet.shape.similarity import Similarity

MAX_MEDIAN_DISTANCE = 25.0
"""Largest median distance in mm from the model's vertices to the scan; beyond it a fit stops."""

INDEPENDENT_POINTS = 1000
"""Matched points whose errors count as independent; errors of neighbours are correlated."""

MIN_CHANGE = 0.01
"""Smallest change of the RMS distance in mm that matters; scanners are not more accurate."""


class IcpStage:
    """Trimmed, non-rigid ICP of section 4.1 of Alotaibi & Smith 2017 on some vertices and modes.

    A stage alternates between nearest points of the scan and the separable fit (Equations 5 to 8).
    `vertices` and `modes` are numbers, 0 for all; `prior` is the least weight of the prior.
    """

    def __init__(
        self,
        model: ShapeModel,
        scan: ScanPoints,
        settings: FitSettings,
        alpha: Float[np.ndarray, "some"],
        vertices: int,
        modes: int,
        prior: float = 0.0,
    ) -> None:
        self.scan, self.settings = scan, settings
        self.millimetres = model.millimetres
        self.prior = max(prior, settings.map_weight)
        self.modes = min(modes or len(model.basis), len(model.basis))
        count = len(model.mean)
        rng = np.random.default_rng(settings.seed)
        whole = vertices == 0 or vertices >= count
        # A slice gives a view of the basis; a list of rows would copy it.
        chosen = slice(None) if whole else np.sort(rng.choice(count, vertices, replace=False))
        self.basis = model.basis[: self.modes, chosen]
        self.mean = model.mean[chosen].astype(np.float64)
        self.variances = model.variances[: self.modes].astype(np.float64)
        self.normals = compute_vertex_normals(model.reconstruct(alpha), model.triangles)[chosen]

    def run(
        self, pose: Similarity, alpha: Float[np.ndarray, "some"]
    ) -> tuple[Similarity, Float[np.ndarray, "modes"], StageRecord]:
        """Iterate from a pose and coefficients until the RMS distance settles."""
        alpha = np.pad(alpha[: self.modes], (0, max(self.modes - len(alpha), 0)))
        history: list[float] = []
        while len(history) < self.settings.iterations and not self._has_settled(history):
            match, kept, rms = self.match(pose(self.reconstruct(alpha)), pose)
            pose, alpha = self._fit(match, kept, pose)[:2]
            history.append(rms)
        record = StageRecord(len(self.mean), self.modes, tuple(history), self._has_settled(history))
        return pose, alpha, record

    def reconstruct(self, alpha: Float[np.ndarray, "modes"]) -> Float[np.ndarray, "chosen 3"]:
        """Compute the stage's vertices in the model's frame."""
        return self.mean + np.tensordot(alpha.astype(self.basis.dtype), self.basis, 1)

    def match(
        self, moved: Float[np.ndarray, "chosen 3"], pose: Similarity
    ) -> tuple[NearestPoints, Bool[np.ndarray, "chosen"], float]:
        """Match nearest points: section 4.1 keeps the 80 % of vertices with the closest matches.

        Returns the matches, which vertices are kept, and the kept ones' RMS distance in mm. Matches
        on the scan's boundary, or with another orientation, are never kept.
        """
        match = self.scan.find_nearest(moved)
        far = np.where(match.on_boundary, np.inf, match.distance)
        if self.settings.normals:
            facing = np.einsum("vk,vk->v", self.normals @ pose.rotation.T, match.normal)
            far[facing < np.cos(np.radians(self.settings.angle))] = np.inf
        last = max(int(np.ceil(self.settings.kept * len(far))) - 1, 0)
        kept = (far <= np.partition(far, last)[last]) & np.isfinite(far)
        millimetres = self.millimetres / pose.scale
        self._check_overlap(match.distance, kept, millimetres)
        across = match.measure_distance(moved)[kept] * millimetres
        return match, kept, float(np.sqrt(np.mean(across**2)))

    def _fit(
        self, match: NearestPoints, kept: Bool[np.ndarray, "chosen"], pose: Similarity
    ) -> Solution:
        normals = match.normal @ pose.rotation if self.settings.normals else None
        weights = kept.astype(np.float64)
        sliding = self.settings.sliding
        moments = compute_moments(self.basis, self.mean, match.point, weights, normals, sliding)
        prior = self.prior * (pose.scale / self.millimetres) ** 2 * kept.sum() / INDEPENDENT_POINTS
        return minimise(SeparableObjective(moments, self.variances, prior), pose)

    def _has_settled(self, history: list[float]) -> bool:
        recent = np.array(history[-3:])
        limit = np.maximum(self.settings.tolerance * recent[1:], MIN_CHANGE)
        return len(recent) == 3 and bool(np.all(np.abs(np.diff(recent)) < limit))

    def _check_overlap(
        self,
        distance: Float[np.ndarray, "chosen"],
        kept: Bool[np.ndarray, "chosen"],
        millimetres: float,
    ) -> None:
        median = float(np.median(distance)) * millimetres
        if median > MAX_MEDIAN_DISTANCE:
            raise InputError(
                f"nothing lies near the model: half of its vertices are more than {median:.0f} mm "
                "away from the scan; check that the landmarks belong to this scan."
            )
        if 3 * kept.sum() < self.modes + 6:
            raise InputError(
                f"only {kept.sum()} of {len(kept)} vertices of the model lie over the scan with a "
                "similar normal; check the landmarks, and that triangles run counter-clockwise."
            )
