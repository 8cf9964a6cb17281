"""How well blood over time is read, on synthetic clips of all tones and movements.

    python -m benchmarks.video [--clips N] [--frames N] [--minutes N] [--seed N] [--peers DIR]
        [--keep DIR] [--json]

Each clip is rendered, compressed as H.264, and tracked. `change` holds correlation `r` and `rmse`
of log ratios of hemoglobin over the frames of all clips of a tone that have an event, by region,
and `coverage` of the 90 % intervals over all clips; `r_clip` is the median over clips of their own
correlations. `onset` is the error of the begin of flushes, in seconds. `pulse` is the mean absolute
error in beats per minute of the tracker beside POS, CHROM and green on the same colours, with the
same windows and spectra; `readable` is over the clips whose pulse the tracker calls clear.
`strong` is the coverage of every fourth clip when it is compressed to .01 to .03 bits a pixel.
`melanin` is one number for a clip: `spread` is the standard deviation of the logarithms of single
looks, `standard_error` that of the pooled one, `drift` the difference between its halves, and
`read_again` is how far the second half, read as a video of its own, is from the whole clip.
`speed` is frames a second of a video of 1280 x 720 on two threads, all results written; `memory` is
by how much a run over so many minutes grows after its first tenth. With --keep, the score of each
clip is written to a folder as soon as it is known, and a run that was cut goes on where it ended.
"""

import pickle
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.report import Results, main
from benchmarks.test_sets import SHARED, find_ict, log
from benchmarks.video_clips import ClipScore, StrongScore, score_clip
from benchmarks.video_peers import PulsePeer, list_peers
from benchmarks.video_resources import measure_memory, measure_speed
from skinnet.errors import InputError
from skinnet.files._partial import write_together
from skinnet.inference import Decomposer
from skinnet.video._least_change import UNREADABLE
from skinnet.video._readings import QUANTILE
from skinnet.video._regions import FACE, NAMES
from train.synthetic.faces import SyntheticFaces
from train.synthetic.videos.clips import Clips

METHODS = ("skinnet", "pos", "chrom", "green")
TONES = ("light", "medium", "dark")
_LEAST, _EARLY = 10, 60
_ICT = str(SHARED / "models" / "ict_facekit.npz")


def measure(
    clips: int = 60,
    frames: int = 90,
    minutes: int = 10,
    seed: int = 0,
    peers: Path | None = None,
    keep: Path | None = None,
) -> Results:
    """Measure every figure.

    Args:
        clips: Number of clips.
        frames: Frames with which speed is measured; 0: it is not.
        minutes: Minutes of video over which memory is measured; 0: it is not.
        seed: Seed of the clips.
        peers: Folder of public networks.
        keep: Folder of the scores of clips; None to keep none.
    """
    if clips < 1 or frames < 0 or minutes < 0:
        raise InputError(
            f"clips is 1 or more, frames and minutes 0 or more; got {clips}, {frames}, {minutes}."
        )
    settings = Clips(clips, seed=seed, ict=find_ict(_ICT))
    decomposer, networks = Decomposer(), list_peers(peers)
    data = settings.make_faces()
    scores: list[ClipScore] = []
    for number in range(clips):
        found = _score(settings, data, number, decomposer, networks, keep)
        scores += [] if found is None else [found]
        log(f"\rClips: {number + 1} of {clips}.")
    log("\n")
    return {
        "clips": clips,
        "refused": clips - len(scores),
        "bits_per_pixel": _average(one.bits for one in scores),
        "change": {tone: measure_change(_choose(scores, tone)) for tone in _list_tones(scores)},
        "coverage": measure_coverage(scores),
        "strong": measure_strong(scores),
        "onset": measure_onset(scores),
        "pulse": {
            **{tone: measure_pulse(_choose(scores, tone)) for tone in _list_tones(scores)},
            **{kind: measure_pulse([one for one in scores if one.plan.motion.kind == kind])
               for kind in ("still", "moving", "talking")},
            "readable": measure_pulse([one for one in scores if one.is_readable]),
        },
        "melanin": measure_melanin(scores),
        "peers": measure_peers(scores, [one.name for one in networks]),
        "speed": measure_speed(settings, data, decomposer, frames) if frames else None,
        "memory": measure_memory(settings, data, decomposer, minutes) if minutes else None,
    }  # fmt: skip


def _score(
    clips: Clips,
    data: SyntheticFaces,
    number: int,
    decomposer: Decomposer,
    networks: Sequence[PulsePeer],
    keep: Path | None,
) -> ClipScore | None:
    """Score a clip, or take its score from the folder."""
    if keep is None:
        return score_clip(clips, data, number, decomposer, networks)
    keep.mkdir(parents=True, exist_ok=True)
    path = keep / f"clip_{clips.seed}_{clips.count}_{number}.pickle"
    if path.is_file():
        kept: ClipScore | None = pickle.loads(path.read_bytes())
        return kept
    found = score_clip(clips, data, number, decomposer, networks)
    with write_together() as temporary:
        temporary(path).write_bytes(pickle.dumps(found))
    return found


def measure_change(scores: Sequence[ClipScore]) -> Results:
    """Measure r and RMSE of the log ratio by region, over the clips with an event.

    `readable` is the face of the clips of which the tracker does not say that it cannot be read.
    """
    some = [one for one in scores if one.plan.course.kind != "none"]
    readable = [one for one in some if _find_least(one) <= UNREADABLE]
    return {
        "clips": len(some),
        **{name: _measure_region(some, index) for index, name in enumerate(NAMES)},
        "readable": {"clips": len(readable)} | _measure_region(readable, NAMES.index(FACE)),
    }


def _find_least(score: ClipScore) -> float:
    """Smallest relative change of the face that is told from none, from its first frames."""
    return float(np.exp(QUANTILE * np.nanmedian(score.sd[:_EARLY, NAMES.index(FACE)])) - 1)


def _measure_region(scores: Sequence[ClipScore], index: int) -> Results:
    pairs = [_pair(one, index) for one in scores]
    truth, change = (np.concatenate([pair[side] for pair in pairs] or [np.empty(0)])
                     for side in (0, 1))  # fmt: skip
    own = [_correlate(*pair) for pair in pairs]
    return {
        "r": _correlate(truth, change),
        "r_clip": _take_median(own),
        "rmse": float(np.sqrt(np.mean((change - truth) ** 2))) if len(truth) else None,
        "mean_sd": _average(np.nanmean(one.sd[:, index]) for one in scores
                            if np.isfinite(one.sd[:, index]).any()),
    }  # fmt: skip


def measure_coverage(scores: Sequence[ClipScore]) -> Results:
    """Share of frames whose 90 % interval holds the truth, by region, tone and movement."""
    groups: dict[str, list[ClipScore]] = {"all": list(scores)}
    for one in scores:
        groups.setdefault(one.tone, []).append(one)
        groups.setdefault(one.plan.motion.kind, []).append(one)
    found: Results = {name: _cover(some, range(len(NAMES))) for name, some in groups.items()}
    return found | {"regions": {name: _cover(scores, [index]) for index, name in enumerate(NAMES)}}


def measure_strong(scores: Sequence[ClipScore]) -> Results | None:
    """Coverage of clips that are compressed strongly, by movement; None without any."""
    found = [(one.plan.motion.kind, one.strong) for one in scores if one.strong is not None]
    if not found:
        return None
    groups: dict[str, list[StrongScore]] = {"all": [one for _, one in found]}
    for kind, one in found:
        groups.setdefault(kind, []).append(one)
    return {
        "clips": len(found),
        "bits_per_pixel": _average(one.bits for _, one in found),
        **{name: _cover(some, range(len(NAMES))) for name, some in groups.items()},
    }


def _cover(scores: Iterable[ClipScore | StrongScore], regions: Iterable[int]) -> float | None:
    inside = [
        np.abs(one.change - one.truth)[:, index][seen] <= QUANTILE * one.sd[:, index][seen]
        for one in scores
        for index in regions
        if (seen := np.isfinite(one.change[:, index]) & np.isfinite(one.truth[:, index])).any()
    ]
    return float(np.concatenate(inside).mean()) if inside else None


def measure_onset(scores: Sequence[ClipScore]) -> Results:
    """Error of the begin of flushes in seconds, and how many events are missed or false."""
    flushes = [one for one in scores if one.plan.course.kind == "flush"]
    errors = [one.onset - one.plan.course.onset for one in flushes if one.onset is not None]
    return {
        "flushes": len(flushes),
        "missed": len(flushes) - len(errors),
        "mean_absolute_s": _average(map(abs, errors)),
        "median_s": _take_median(errors),
        "false_events": sum(one.false_events for one in scores),
    }


def measure_pulse(scores: Sequence[ClipScore]) -> Results:
    """Mean absolute error of the pulse in beats per minute, by method."""
    results: Results = {"clips": len(scores)}
    return results | {name: _measure_errors(scores, name) for name in METHODS}


def measure_peers(scores: Sequence[ClipScore], names: Sequence[str]) -> Results | None:
    """The same of public networks; None without any."""
    return {name: _measure_errors(scores, name) for name in names} or None


def _measure_errors(scores: Sequence[ClipScore], method: str) -> float | None:
    """Mean absolute error of the pulse of one method."""
    return _average(
        abs(rate - one.plan.course.rate)
        for one in scores
        if (rate := one.pulse.get(method)) is not None
    )


def measure_melanin(scores: Sequence[ClipScore]) -> Results:
    """How constant melanin is, as relative differences."""
    again = [abs(second / first - 1) for one in scores
             if (first := one.melanin[0]) and (second := one.melanin[1])]  # fmt: skip
    truth = [abs(np.log(one.melanin[0] / one.plan.melanin)) for one in scores]
    told = [one.constancy for one in scores]
    drifts = [abs(drift) for one in told if (drift := one.get("drift")) is not None]
    return {
        "spread": _take_median(one.get("spread") for one in told),
        "standard_error": _take_median(one.get("standard_error") for one in told),
        "drift_median": _take_median(drifts),
        "drift_p90": float(np.percentile(drifts, 90)) if drifts else None,
        "read_again_median": _take_median(again),
        "read_again_p90": float(np.percentile(again, 90)) if again else None,
        "log_error_median": _take_median(truth),
    }


def _list_tones(scores: Sequence[ClipScore]) -> list[str]:
    return [tone for tone in TONES if any(one.tone == tone for one in scores)]


def _choose(scores: Sequence[ClipScore], tone: str) -> list[ClipScore]:
    return [one for one in scores if one.tone == tone]


def _pair(score: ClipScore, index: int) -> tuple[Any, Any]:
    truth, change = score.truth[:, index], score.change[:, index]
    seen = np.isfinite(truth) & np.isfinite(change)
    return truth[seen], change[seen]


def _correlate(truth: Any, change: Any) -> float | None:
    if len(truth) < _LEAST or np.std(truth) == 0 or np.std(change) == 0:
        return None
    return float(np.corrcoef(truth, change)[0, 1])


def _average(values: Iterable[Any]) -> float | None:
    return _reduce(np.mean, values)


def _take_median(values: Iterable[Any]) -> float | None:
    return _reduce(np.median, values)


def _reduce(function: Callable[..., Any], values: Iterable[Any]) -> float | None:
    finite = [float(one) for one in values if one is not None and np.isfinite(one)]
    return float(function(finite)) if finite else None


if __name__ == "__main__":
    main(
        measure,
        (__doc__ or "").splitlines()[0],
        paths={
            "peers": "folder of public pulse networks as .onnx; none by default",
            "keep": "folder of the scores of clips, with which a run that was cut goes on",
        },
        counts={
            "clips": "number of clips; 60 by default",
            "frames": "frames with which speed is measured; 90 by default, 0 for none",
            "minutes": "minutes of video over which memory is measured; 10 by default, 0 for none",
            "seed": "seed of the clips; 0 by default",
        },
    )
