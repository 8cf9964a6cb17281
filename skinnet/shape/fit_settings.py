"""Settings of a fit, and the record of each of its stages."""

import math
from dataclasses import dataclass

from skinnet.errors import InputError, _check_count


@dataclass(frozen=True)
class FitSettings:
    """Settings of the fit of a model to a scan.

    Args:
        kept: Share of the model's vertices, those with the closest matches, that a step fits.
        normals: Measure to the scan's tangent planes, and drop matches with another orientation.
        sliding: With `normals`, the weight in [0, 1] of a squared residual along the surface.
        angle: With `normals`, the largest angle in degrees between a vertex's normal and its
            match's.
        map_weight: Weight of the prior on the coefficients, relative to 1,000 matched points that
            are accurate to 1 mm, however many are matched; 0 is the paper's fit.
        stages: For each stage, coarse to fine, the numbers of vertices and modes (0 for all) and
            the least weight of the prior, while matches are still rough.
        iterations: Largest number of steps in each stage.
        tolerance: A stage ends when the kept vertices' RMS distance changes, twice in a row, by
            less than this share of it or by less than 0.01 mm.
        seed: Seed of the random choice of vertices in the coarse stages.

    Raises:
        InputError: If a value is out of range.

    Source:
        Section 4.1 of Alotaibi & Smith 2017; `FitSettings(normals=False, map_weight=0.0)` is the
        paper's fit.

    Example:
        >>> from skinnet.shape import FitSettings
        >>> FitSettings(kept=0.9).kept
        0.9
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
        if not 0 <= self.map_weight < math.inf:
            raise InputError(f"map_weight is 0 or more; got {self.map_weight}.")
        if not 0 < self.angle <= 180:
            raise InputError(f"angle is in (0, 180] degrees; got {self.angle}.")
        if not 0 <= self.tolerance < math.inf:
            raise InputError(f"tolerance is 0 or more; got {self.tolerance}.")
        _check_count("iterations", self.iterations, 1)
        _check_count("seed", self.seed)
        if not self.stages:
            raise InputError("stages is empty; give at least [[0, 0]], all vertices and modes.")
        for stage in self.stages:
            if not all(0 <= value < math.inf for value in stage):
                raise InputError(f"a stage has numbers that are 0 or more; got {list(stage)}.")


@dataclass(frozen=True)
class StageRecord:
    """What one stage of a fit did.

    Attributes:
        vertices: Number of vertices.
        modes: Number of modes.
        rms: RMS distance in mm of the kept vertices before each step.
        converged: Whether the distance settled before the iterations ran out.
    """

    vertices: int
    modes: int
    rms: tuple[float, ...]
    converged: bool
