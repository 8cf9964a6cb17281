"""Nothing is lost or half-written whatever strikes; `python -m benchmarks.interruptions` has more.

Processes are killed at random moments, disks are full, and refuse writing. What is left is whole,
and the same command ends as one that nothing struck.
"""

import sys

import pytest

from benchmarks.interruptions.__main__ import summarise
from benchmarks.interruptions.faults import FULL, KILL, READ_ONLY, Fault
from benchmarks.interruptions.scenes import SCENES, Scene
from benchmarks.interruptions.trials import Trial, run_trials

COUNTS = {
    "training": {KILL: 2, FULL: 1},
    "predict": {KILL: 1, FULL: 1, READ_ONLY: 1},
    "edit": {FULL: 1},
    "scans": {KILL: 1},
}
"""Number of faults of each kind: few, since each runs the commands of a scene twice."""


@pytest.mark.slow
@pytest.mark.skipif(sys.platform != "linux", reason="Processes and disks are those of Linux.")
@pytest.mark.parametrize("scene", SCENES, ids=lambda scene: scene.name)
def test_what_a_fault_leaves_is_whole_and_the_next_run_heals_it(scene: Scene) -> None:

    trials = run_trials(scene, COUNTS[scene.name], seed=1, tell=lambda trial: None)
    assert [trial for trial in trials if trial.faults] == []


def test_trials_are_counted_by_scene_and_kind() -> None:
    trials = [
        Trial("edit", Fault(KILL, write=1), ()),
        Trial("edit", Fault(KILL, seconds=1.0), ("a.png is lost",)),
        Trial("edit", Fault(FULL, size=1), ()),
    ]
    found = summarise(trials)
    assert found == {"edit": {KILL: {"tried": 2, "survived": 1}, FULL: {"tried": 1, "survived": 1}}}
