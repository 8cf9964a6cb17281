"""The dynamic model, fitted to what `skinnet track` reads of synthetic clips with a flush.

    python -m benchmarks.dynamic --ict ict_facekit.npz --json

The amounts are those of the clips' courses. The fitted flush in the middle of five places stands
beside that of a fit to the true changes of the same regions.
"""

import argparse
import json
import sys
from collections.abc import Sequence
from contextlib import redirect_stdout
from io import StringIO
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from skinnet.appearance import BloodSequence, DynamicModel
from skinnet.appearance._track_rows import REGIONS, spread_regions
from skinnet.cli import main as run_skinnet
from skinnet.video._regions import NAMES
from train.synthetic.videos.clip_files import write_clip
from train.synthetic.videos.clip_renderer import ClipRenderer, ClipSettings
from train.synthetic.videos.clips import Clips

PLACES = {"left cheek": 280, "right cheek": 50, "nose": 4, "forehead": 151, "chin": 199}
"""Landmarks in the middle of the places."""

_BASELINE = 0.2
"""Share of a clip that is its baseline; flushes begin later."""


def measure(clips: Clips, count: int) -> dict[str, Any]:
    """Track the first clips with a flush, and fit the model to them and to the truth."""
    data, read, true = clips.make_faces(), [], []
    numbers = [number for number in range(clips.count) if number // 3 % 3 == 0][:count]
    for number in numbers:
        renderer = clips.make_renderer(data, clips.plan(number))
        table = _track(renderer, clips.plan(number).quality)
        if table is not None:
            read.append(table)
            true.append(_follow_truth(renderer, table))
    models = {
        name: DynamicModel.fit(sequences, seconds={})
        for name, sequences in (("tracked", read), ("true", true))
    }
    return {
        "clips": len(read),
        "not_tracked": len(numbers) - len(read),
        **{
            name: {"held_out": dict(model.errors), "flush": _list_places(model)}
            for name, model in models.items()
        },
    }


def _track(renderer: ClipRenderer, quality: int) -> BloodSequence | None:
    """What the command reads of a clip; None if it cannot be read."""
    with TemporaryDirectory() as folder:
        video = Path(folder) / "clip.mp4"
        write_clip(video, renderer, quality)
        end = _BASELINE * renderer.settings.seconds
        words = ["track", str(video), "-o", folder, "--baseline", f"0,{end:g}", "--no-map", "-q"]
        with redirect_stdout(StringIO()):
            if run_skinnet(words):
                return None
        table = Path(folder) / "clip_track.csv"
        times = BloodSequence.from_track(table).times
        amounts = {"flush": np.asarray(renderer.course.event(times), np.float64)}
        return BloodSequence.from_track(table, amounts)


def _follow_truth(renderer: ClipRenderer, table: BloodSequence) -> BloodSequence:
    rows = np.array([renderer.true_change(time) for time in table.times.tolist()], np.float64)
    ratios = rows[:, [NAMES.index(name) for name in REGIONS]]
    change = spread_regions(ratios, DynamicModel.load().landmarks, len(table.rest))
    return BloodSequence(table.rest, table.rest * np.exp(change), table.times, table.coefficients)


def _list_places(model: DynamicModel) -> dict[str, float]:
    flush, size = model.mean[model.names.index("flush")], model.mean.shape[-1]
    places = {name: (model.landmarks[number] * size).astype(int) for name, number in PLACES.items()}
    return {name: round(float(flush[row, column]), 3) for name, (column, row) in places.items()}


def main(argv: Sequence[str] | None = None) -> int:
    """Print the figures; return 0."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--json", action="store_true", help="print one line of JSON")
    parser.add_argument("--clips", type=int, default=8, help="clips that are tracked")
    parser.add_argument("--seconds", type=float, default=9.0, help="length of each")
    parser.add_argument("--size", type=int, default=288, help="side of the frames in pixels")
    parser.add_argument("--seed", type=int, default=3)
    parser.add_argument("--heads", type=int, default=64, help="heads that the clips share")
    parser.add_argument("--ict", help="file of ICT-FaceKit; without it all heads are procedural")
    parser.add_argument("--geometry", default="runs/geometry", help="folder of the heads")
    given = parser.parse_args(argv)
    settings = ClipSettings(given.seconds, 20.0, given.size)
    clips = Clips(
        3 * given.clips,
        settings,
        given.seed,
        given.heads,
        ict=given.ict,
        geometry=given.geometry,
    )
    figures = measure(clips, given.clips)
    print(json.dumps(figures, indent=None if given.json else 1))
    return 0


if __name__ == "__main__":
    sys.exit(main())
