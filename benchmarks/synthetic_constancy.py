"""How constant the reading of rendered faces is, and how it follows their pigments."""

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from benchmarks.capture_spreads import describe_shots, measure_spreads
from benchmarks.pair_rows import score_reading
from benchmarks.pigment_changes import FACTORS, average, fit_slope
from benchmarks.portraits import PIGMENTS
from benchmarks.reader import NetworkReader
from benchmarks.repeated_faces import RepeatedFaces, Shot, render_changed, render_people
from benchmarks.report import Results
from benchmarks.skin_readings import SkinReading, read_skin, stack_readings
from skinnet.inference._agreement import find_sessions
from skinnet.inference._fusion import SHARED, Fusion, fuse_readings
from skinnet.inference._uncertainty import LEVEL, find_factor


def measure_people(
    settings: RepeatedFaces, readers: Mapping[str, NetworkReader]
) -> tuple[dict[str, Results], Results]:
    """Measure readings of people in several captures, by network, and their colour's spread."""
    readings: dict[str, list[SkinReading]] = {name: [] for name in readers}
    truths, described = [], []
    for shots in render_people(settings):
        truths.append(shots[0].truth)
        described.append(describe_shots(shots))
        for name, reader in readers.items():
            readings[name].append(read_shots(shots, reader))
    truth, colours = np.stack(truths), np.stack(described)
    scores = {
        name: _score(stack_readings(readings[name]), colours, truth, reader)
        for name, reader in readers.items()
    }
    return scores, measure_spreads(colours[:, :2])


def _score(
    reading: SkinReading,
    colours: NDArray[np.floating],
    truth: NDArray[np.floating],
    reader: NetworkReader,
) -> Results:
    first = SkinReading(reading.pigments[:, :2], reading.sd[:, :2], {})
    return {
        "pairs": score_reading(first, reader.model.decoder),
        "single": correlate(reading.pigments[:, 0], truth),
        f"fused{reading.sd.shape[1]}": score_fused(reading, colours[..., :2], truth),
    }


def score_fused(
    reading: SkinReading, colours: NDArray[np.floating], truth: NDArray[np.floating]
) -> Results:
    """Score people that are fused as `skinnet person` does, and how far their shots err alike.

    Args:
        reading: Readings [people, shots, 2].
        colours: Log R/G and log B/G of the skin in the photographs, [people, shots, 2].
        truth: Natural logarithms of the true fractions, [people, 2].
    """
    people = fuse_people(reading, colours)
    found = correlate(np.stack([fused.value for fused in people], -1), truth)
    for index, (name, fused) in enumerate(zip(PIGMENTS, people, strict=True)):
        shots = reading.pigments[..., index], reading.sd[..., index]
        found[name]["coverage"] = measure_coverage(fused, truth[:, index])
        found[name]["error_correlation"] = correlate_errors(*shots, truth[:, index])
    return found


def measure_changes(
    settings: RepeatedFaces, readers: Mapping[str, NetworkReader]
) -> dict[str, Results]:
    """Measure, by network, slopes of log readings on logarithms of rendered fractions."""
    slopes: dict[tuple[str, str, str], list[float]] = {}
    for name, shots in render_changed(settings, FACTORS):
        index = PIGMENTS.index(name)
        true = np.exp([one.truth[index] for one in shots])
        for row, reader in readers.items():
            for way in ("blind", "known"):
                read = read_shots(shots, reader, way == "known").pigments[:, index]
                slopes.setdefault((row, way, name), []).append(fit_slope(read, true))
    found: dict[str, Results] = {row: {"blind": {}, "known": {}} for row in readers}
    for (row, way, name), some in slopes.items():
        found[row][way][name] = average(some)
    return found


def read_shots(shots: Sequence[Shot], reader: NetworkReader, told: bool = False) -> SkinReading:
    """Read photographs, with their captures known or not."""
    return stack_readings(
        read_skin(reader, one.photograph, known=one.known if told else None) for one in shots
    )


def fuse(reading: SkinReading) -> NDArray[np.float64]:
    """Fuse the readings [..., shots, 2] of each person, by their inverse variances, to [..., 2]."""
    return fuse_readings(reading.pigments.swapaxes(-1, -2), reading.sd.swapaxes(-1, -2)).value


def fuse_people(reading: SkinReading, colours: NDArray[np.floating]) -> tuple[Fusion, Fusion]:
    """Fuse the readings of people as `skinnet person` does.

    Args:
        reading: Readings [people, shots, 2].
        colours: Log R/G and log B/G of the skin in the photographs, [people, shots, 2].

    Returns:
        Of melanin and of hemoglobin, [people] each.
    """
    sessions = np.stack([find_sessions(shots) for shots in colours])
    melanin, hemoglobin = (
        fuse_readings(reading.pigments[..., index], reading.sd[..., index], SHARED[name], sessions)
        for index, name in enumerate(PIGMENTS)
    )
    return melanin, hemoglobin


def measure_coverage(fused: Fusion, log_truth: NDArray[np.floating]) -> float:
    """Measure which share of the intervals of people [people] hold the truth."""
    return measure_interval_coverage(fused.value - log_truth, fused.sd)


def measure_interval_coverage(errors: NDArray[np.floating], sd: NDArray[np.floating]) -> float:
    """Measure which share of intervals hold the truth; NaN is left out.

    Args:
        errors: Errors of logarithms, [n].
        sd: Their standard deviations as stated, [n].
    """
    seen = np.isfinite(errors)
    widths = np.array([np.log(find_factor(one, LEVEL)) for one in sd[seen].tolist()])
    return float((np.abs(errors[seen]) <= widths).mean())


def correlate_errors(
    log_read: NDArray[np.floating], sd: NDArray[np.floating], log_truth: NDArray[np.floating]
) -> float:
    """Correlate the errors of two shots of a person, each in the shot's standard deviations.

    Args:
        log_read: A pigment in each shot, [people, shots].
        sd: The standard deviations that the shots state, [people, shots].
        log_truth: The true one, [people].
    """
    errors = (log_read - log_truth[:, None]) / sd
    errors = errors[np.isfinite(errors).all(1)]
    shots = errors.shape[1]
    pairs = (errors.sum(1) ** 2 - (errors**2).sum(1)).mean() / (shots * (shots - 1))
    return float(pairs / (errors**2).mean())


def correlate(log_read: NDArray[np.floating], log_truth: NDArray[np.floating]) -> Results:
    """Correlate fractions read with true ones, [people, 2], and their logarithms (`r_log`)."""
    seen = np.isfinite(log_read).all(-1) & np.isfinite(log_truth).all(-1)
    found: Results = {}
    for index, name in enumerate(PIGMENTS):
        read, truth = log_read[seen, index], log_truth[seen, index]
        found[name] = {
            "r": float(np.corrcoef(np.exp(read), np.exp(truth))[0, 1]),
            "r_log": float(np.corrcoef(read, truth)[0, 1]),
        }
    return found
