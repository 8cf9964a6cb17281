"""What a fit is asked to do, and what each of its stages did."""

from dataclasses import dataclass

from skinnet.errors import InputError


@dataclass(frozen=True)
class FitSettings:
    """How a model is fitted to a scan (Alotaibi & Smith 2017, section 4.1).

    Args:
        kept: share of the model's vertices, those with the closest matches, that a step fits.
        normals: measure across the scan's surface, and drop matches that face another way.
        sliding: with `normals`, what a squared residual along the surface counts, in [0, 1].
        angle: with `normals`, the largest angle in degrees between a vertex and its match.
        map_weight: weight of the prior on the coefficients against a surface that tells as much as
            1,000 points accurate to 1 mm, however many are matched; 0 is the paper's fit.
        stages: numbers of vertices and of modes, coarse to fine, 0 for all, and the least prior
            while the matches are still rough.
        iterations: largest number of steps in each stage.
        tolerance: a stage ends when the kept vertices' RMS distance changes, twice in a row, by
            less than this share of it or by less than 0.01 mm.
        seed: of the choice of vertices in the coarse stages.
    """

    kept: float = 0.8
    normals: bool = True
    sliding: float = 0.1
    angle: float = 60.0
    map_weight: float = 1.0
    stages: tuple[tuple[int, int, float], ...] = (
        (1000, 20, 30.0),
        (2500, 60, 2.0),
        (8000, 0, 0.1),
        (0, 0, 0.0),
    )
    iterations: int = 30
    tolerance: float = 1e-2
    seed: int = 0

    def __post_init__(self) -> None:
        if not 0 < self.kept <= 1:
            raise InputError(f"kept is a share of the vertices in (0, 1]; got {self.kept}.")
        if not 0 <= self.sliding <= 1:
            raise InputError(f"sliding is a weight in [0, 1]; got {self.sliding}.")
        if self.map_weight < 0:
            raise InputError(f"map_weight is 0 or more; got {self.map_weight}.")
        if not self.stages:
            raise InputError("stages is empty; give at least [[0, 0]], all vertices and modes.")


@dataclass(frozen=True)
class StageRecord:
    """One stage of a fit: RMS distance in mm of the kept vertices before each step."""

    vertices: int
    modes: int
    rms: tuple[float, ...]
    converged: bool
