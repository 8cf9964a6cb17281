"""Kills, full disks and disks of no writing: `python -m benchmarks.interruptions [--json]`.

Each scene runs over small inputs in a folder that has results of an earlier run and a file of the
user. A fault strikes: `kill -9` at a random time or before a random write, a disk that is full
after a random number of bytes, or one that refuses writing from a random write on. Then every file
must be the earlier one or the new one, whole; and after the same command without a fault (training
goes on from its last checkpoint) all files and losses must be those of a run without a fault, and
partial files removed and named.
"""

import argparse
import json
import sys
from collections import Counter

from benchmarks.interruptions.scenes import SCENES
from benchmarks.interruptions.trials import KINDS, Trial, run_trials


def main() -> int:
    """Run the scenes and print how many trials of each kind were survived."""
    options = _parse()
    trials: list[Trial] = []
    for scene in SCENES:
        if scene.name in options.scenes:
            counts = dict.fromkeys(options.kinds, options.count)
            trials += run_trials(scene, counts, options.seed, _tell)
    summary = summarise(trials)
    print(json.dumps(summary) if options.json else draw_table(summary))
    return int(any(trial.faults for trial in trials))


def summarise(trials: list[Trial]) -> dict[str, dict[str, dict[str, int]]]:
    """Count, for each scene and kind of fault, what was tried and survived."""
    tried = Counter((trial.scene, trial.fault.kind) for trial in trials)
    survived = Counter((each.scene, each.fault.kind) for each in trials if not each.faults)
    return {
        scene: {
            kind: {"tried": tried[scene, kind], "survived": survived[scene, kind]}
            for kind in KINDS
            if tried[scene, kind]
        }
        for scene in dict.fromkeys(trial.scene for trial in trials)
    }


def draw_table(summary: dict[str, dict[str, dict[str, int]]]) -> str:
    """Draw the counts as a table of Markdown."""
    lines = [f"| scene | {' | '.join(KINDS)} |", "|---|" + "---|" * len(KINDS)]
    for scene, found in summary.items():
        cells = [
            f"{found[kind]['survived']} of {found[kind]['tried']}" if kind in found else ""
            for kind in KINDS
        ]
        lines.append(f"| {scene} | {' | '.join(cells)} |")
    return "\n".join(lines)


def _parse() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__)
    names = [scene.name for scene in SCENES]
    parser.add_argument("--scenes", nargs="+", choices=names, default=names)
    parser.add_argument("--kinds", nargs="+", choices=KINDS, default=KINDS)
    parser.add_argument("--count", type=int, default=20, help="faults of each kind and scene")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--json", action="store_true")
    return parser.parse_args()


def _tell(trial: Trial) -> None:
    place = {name: value for name, value in trial.fault._asdict().items() if value is not None}
    print(f"{trial.scene} {place}: {'; '.join(trial.faults) or 'survived'}", file=sys.stderr)


if __name__ == "__main__":
    sys.exit(main())
