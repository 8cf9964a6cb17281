"""Trimmed iterative closest points: one stage of a fit, on some of the vertices and modes."""

import numpy as np
from jaxtyping import Bool, Float

from skinnet.errors import InputError
from skinnet.mesh.normals import compute_vertex_normals
from skinnet.shape._moments import gather
from skinnet.shape._scan_points import Nearest, ScanPoints
from skinnet.shape._separable import Separable, Solution, solve
from skinnet.shape.fit_settings import FitSettings, StageRecord
from skinnet.shape.model import ShapeModel
from skinnet.shape.similarity import Similarity

NEAR = 25.0
"""A scan that half of the model's vertices miss by more than this, in mm, is another object."""


INDEPENDENT = 1000
"""Matched points that err independently of each other; the others only repeat their neighbours."""

STILL = 0.01
"""A change of the RMS distance in mm that no scanner sees."""


class Stage:
    """Alternates nearest points and the separable fit on `vertices` and `modes` (0: all)."""

    def __init__(
        self,
        model: ShapeModel,
        surface: ScanPoints,
        settings: FitSettings,
        alpha: Float[np.ndarray, "some"],
        vertices: int,
        modes: int,
        prior: float = 0.0,
    ):
        self.surface, self.settings = surface, settings
        self.millimetres = model.millimetres
        self.prior = max(prior, settings.map_weight)
        self.modes = min(modes or len(model.basis), len(model.basis))
        count = len(model.mean)
        draw = np.random.default_rng(settings.seed)
        whole = vertices == 0 or vertices >= count
        # A slice leaves the basis where it is; a list of rows would copy it.
        chosen = slice(None) if whole else np.sort(draw.choice(count, vertices, replace=False))
        self.basis = model.basis[: self.modes, chosen]
        self.mean = model.mean[chosen].astype(np.float64)
        self.variances = model.variances[: self.modes].astype(np.float64)
        self.normals = compute_vertex_normals(model.reconstruct(alpha), model.triangles)[chosen]

    def run(
        self, pose: Similarity, alpha: Float[np.ndarray, "some"]
    ) -> tuple[Similarity, Float[np.ndarray, "modes"], StageRecord]:
        """Steps from a pose and coefficients until they move little, or run out."""
        alpha = np.pad(alpha[: self.modes], (0, max(self.modes - len(alpha), 0)))
        history: list[float] = []
        while len(history) < self.settings.iterations and not self._still(history):
            match, kept, rms = self.matches(pose(self.shape(alpha)), pose)
            pose, alpha = self._fitted(match, kept, pose)[:2]
            history.append(rms)
        record = StageRecord(len(self.mean), self.modes, tuple(history), self._still(history))
        return pose, alpha, record

    def shape(self, alpha: Float[np.ndarray, "modes"]) -> Float[np.ndarray, "chosen 3"]:
        """The stage's vertices in the model's frame."""
        return self.mean + np.tensordot(alpha.astype(self.basis.dtype), self.basis, 1)

    def matches(
        self, moved: Float[np.ndarray, "chosen 3"], pose: Similarity
    ) -> tuple[Nearest, Bool[np.ndarray, "chosen"], float]:
        """Nearest points, which vertices are kept, and their RMS distance in mm."""
        match = self.surface.nearest(moved)
        far = np.where(match.boundary, np.inf, match.distance)
        if self.settings.normals:
            facing = np.einsum("vk,vk->v", self.normals @ pose.rotation.T, match.normal)
            far[facing < np.cos(np.radians(self.settings.angle))] = np.inf
        wanted = max(int(np.ceil(self.settings.kept * len(far))) - 1, 0)
        kept = (far <= np.partition(far, wanted)[wanted]) & np.isfinite(far)
        millimetres = self.millimetres / pose.scale
        self._check(match.distance, kept, millimetres)
        across = match.across(moved)[kept] * millimetres
        return match, kept, float(np.sqrt(np.mean(across**2)))

    def _fitted(
        self, match: Nearest, kept: Bool[np.ndarray, "chosen"], pose: Similarity
    ) -> Solution:
        normals = match.normal @ pose.rotation if self.settings.normals else None
        weights = kept.astype(np.float64)
        sliding = self.settings.sliding
        moments = gather(self.basis, self.mean, match.point, weights, normals, sliding)
        prior = self.prior * (pose.scale / self.millimetres) ** 2 * kept.sum() / INDEPENDENT
        return solve(Separable(moments, self.variances, prior), pose)

    def _still(self, history: list[float]) -> bool:
        recent = np.array(history[-3:])
        limit = np.maximum(self.settings.tolerance * recent[1:], STILL)
        return len(recent) == 3 and bool(np.all(np.abs(np.diff(recent)) < limit))

    def _check(
        self,
        distance: Float[np.ndarray, "chosen"],
        kept: Bool[np.ndarray, "chosen"],
        millimetres: float,
    ) -> None:
        middle = float(np.median(distance)) * millimetres
        if middle > NEAR:
            raise InputError(
                f"nothing lies near the model: half of its vertices are more than {middle:.0f} mm "
                "away from the scan; check that the landmarks belong to this scan."
            )
        if 3 * kept.sum() < self.modes + 6:
            raise InputError(
                f"only {kept.sum()} of {len(kept)} vertices of the model lie over the scan and "
                "face as it does; check the landmarks, and that triangles run counter-clockwise."
            )
