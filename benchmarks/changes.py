"""How well changes of pigments are found between two photographs of one synthetic face.

Each face is photographed twice, in two wide captures; in the second one melanin and hemoglobin of
the whole face are multiplied by factors between a half and two. Light, camera, processing and, in
half of the pairs, wall and clothes differ, too. Then the same faces are compared without a change.

    python -m benchmarks.changes [--pairs N] [--json]
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from benchmarks.pictures import choose_known
from benchmarks.portraits import PIGMENTS
from benchmarks.repeated_faces import (
    RepeatedFaces,
    Shot,
    fix_exposure,
    scale_pigment,
    split_shots,
)
from benchmarks.report import Results, main
from benchmarks.scene_chart import read_scene_chart
from benchmarks.synthetic_constancy import measure_interval_coverage
from skinnet.errors import InputError
from skinnet.inference import Decomposer, compare_photographs
from skinnet.inference.capture_profile import CaptureProfile
from skinnet.inference.comparison import Comparison
from skinnet.physics import Capture
from train.synthetic.faces import COLLATE, SyntheticFaces, SyntheticScenes
from train.synthetic.scene import SceneParameters

LARGEST = float(np.log(2))
"""Largest log change of a pigment."""

KNOWN: Mapping[str, tuple[str, ...]] = {
    "blind": (),
    "white": ("white_balance",),
    "light_and_camera": ("white_balance", "light", "temperature", "camera", "linear"),
}
"""Parts that are known of both captures, by key."""

CHART = "chart"
"""Key of a chart beside the face in both photographs."""


class Pair(NamedTuple):
    """Two photographs of a face, and the true log changes of melanin and hemoglobin [2].

    `charts` is what a chart beside the face tells of each photograph; None where it is refused.
    """

    shots: tuple[Shot, Shot]
    change: NDArray[np.float64]
    charts: tuple[CaptureProfile | None, CaptureProfile | None]


class Found(NamedTuple):
    """True and found log changes of a pair [2], their standard deviations, and the verdict."""

    truth: NDArray[np.float64]
    change: NDArray[np.float64]
    sd: NDArray[np.float64]
    unchanged: bool


@dataclass(frozen=True)
class ChangedFaces:
    """Sizes and sources of the pairs.

    Attributes:
        pairs: Pairs with a change, and as many without.
        faces: How the faces are made.
    """

    pairs: int = 64
    faces: RepeatedFaces = RepeatedFaces(heads=32)


def measure(pairs: int = ChangedFaces.pairs, known: tuple[str, ...] = ("blind",)) -> Results:
    """Measure how well changes are found.

    Args:
        pairs: Number of pairs with a change; as many are compared without one.
        known: Keys of `KNOWN`, or `chart`: what to measure.

    Returns:
        By key, of each pigment `r` (correlation of true and found log changes), `rmse` and
        `coverage` of the 90 % intervals; `unchanged` (share of pairs without a change that are
        called so), `noticed` (share of pairs with a change that are not), and `refused` (share of
        pairs that are not compared).
    """
    if pairs < 3:
        raise InputError(f"A correlation needs 3 pairs or more; got {pairs}.")
    settings, decomposer = ChangedFaces(pairs), Decomposer()
    changed = list(render_pairs(settings, LARGEST))
    same = list(render_pairs(settings, 0.0))
    return {key: score(*(_compare_all(decomposer, some, key) for some in (changed, same)))
            for key in known}  # fmt: skip


def render_pairs(settings: ChangedFaces, largest: float) -> Iterator[Pair]:
    """Render pairs, with log changes up to a largest one."""
    data = settings.faces.make_faces()
    scenes = data.test_dataloader().dataset
    assert isinstance(scenes, SyntheticScenes)
    rng = np.random.default_rng([settings.faces.seed, 5])
    for number in range(settings.pairs):
        change = rng.uniform(-largest, largest, 2)
        yield _render(data, scenes[number], scenes[number + settings.pairs], change, number % 2)


def _render(
    data: SyntheticFaces,
    first: SceneParameters,
    second: SceneParameters,
    change: NDArray[np.float64],
    elsewhere: int,
) -> Pair:
    second = second._replace(head=first.head, face=first.face)
    if not elsewhere:
        second = second._replace(surroundings=first.surroundings)
    for name, log in zip(PIGMENTS, change.tolist(), strict=True):
        second = scale_pigment(second, name, float(np.exp(log)))
    # A mirrored picture would not be the same face.
    mirror = first.camera.mirror
    second = second._replace(camera=second.camera._replace(mirror=mirror))
    scenes = [fix_exposure(data, one) for one in (first, second)]
    before, after = split_shots(data.render(COLLATE["mild"](scenes), "test"))
    charts = (
        read_scene_chart(COLLATE["mild"]([one]), data.decoder.camera, "test", number)
        for number, one in enumerate(scenes)
    )
    return Pair((before, after), change, (next(charts), next(charts)))


def _compare_all(decomposer: Decomposer, pairs: list[Pair], key: str) -> list[Found | None]:
    return [_compare(decomposer, pair, key) for pair in pairs]


def _compare(decomposer: Decomposer, pair: Pair, key: str) -> Found | None:
    before, after = pair.shots
    told = pair.charts if key == CHART else tuple(_tell(one, KNOWN[key]) for one in pair.shots)
    try:
        found = compare_photographs(
            before.photograph,
            after.photograph,
            decomposer=decomposer,
            before_capture=told[0],
            after_capture=told[1],
        )
    except InputError:
        return None
    return Found(pair.change, *_read(found), found.face.unchanged)


def _tell(shot: Shot, known: tuple[str, ...]) -> Capture:
    """The parts of a capture that are known."""
    return choose_known(shot.known, known).map(lambda value: value[0])


def _read(found: Comparison) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    changes = [getattr(found.face, name) for name in PIGMENTS]
    return np.array([one.log for one in changes]), np.array([one.sd for one in changes])


def score(changed: list[Found | None], same: list[Found | None]) -> Results:
    """Score pairs with and without a change; None is a pair that was refused."""
    found = [one for one in changed if one is not None]
    still = [one for one in same if one is not None]
    truth, change, sd = (np.stack([one[place] for one in found]) for place in range(3))
    results: Results = {}
    for index, name in enumerate(PIGMENTS):
        error = change[:, index] - truth[:, index]
        results[name] = {
            "r": float(np.corrcoef(truth[:, index], change[:, index])[0, 1]),
            "rmse": float(np.sqrt(np.mean(error**2))),
            "coverage": measure_interval_coverage(error, sd[:, index]),
        }
    results["unchanged"] = float(np.mean([one.unchanged for one in still]))
    results["noticed"] = float(np.mean([not one.unchanged for one in found]))
    results["refused"] = 1 - (len(found) + len(still)) / (len(changed) + len(same))
    return results


if __name__ == "__main__":
    main(
        measure,
        "How well changes of pigments are found between two photographs of one synthetic face.",
        counts={"pairs": "pairs with a change, and as many without; 64 by default"},
    )
