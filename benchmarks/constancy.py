"""Whether what is read belongs to the person, and not to the photograph.

    python -m benchmarks.constancy [--json] [--every N]

`pairs` is over the people of `congress_pairs` that no training saw, each in two official portraits
by different photographers. A face's figure is the logarithm of the mean fraction over its skin;
`angle` is the typology angle, in degrees under D65, of the skin that is read. Each has the
intraclass correlation of single readings (`icc`, with its 95 % interval over people), and the
standard deviations within and between people. `rank_other` is the rank of the angle with the raw
angle of the other photograph, and `validity` the same correlation over that of a perfect reading.
`coverage` is how often the 90 % interval of the difference of both readings holds zero, and
`stated_sd` the median standard deviation that readings state.

`baselines` are uncorrected pixels, grey world, OpenCV's learned white balance (where it is at
hand), a linear map from the colours of 25 places in one photograph to the other's reading or raw
angle, and the fourth model. `captures` is the spread of skin's raw colour within a person, in the
portraits and in synthetic captures.

`guards` say whether it is the skin that is read: `grey` is the same network on grey pictures;
`slope` is that of the log reading on the log factor where only a pigment is changed, by the
network's own colours (`slope_by_fourth`: by those of the fourth model, whose scale of pigments is
another), in the portraits of the kept people (`blind`) and of London with its wall as a white
reference (`known`). `slope_synthetic` changes the pigment of rendered faces.

`synthetic` is over rendered faces in two captures (`pairs`) and five, fused by their inverse
variances (`fused5`). `second_source` is over two degradations of each photograph of London, and of
portraits of people who are not among the pairs. --every N takes every Nth person and face.
"""

import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from benchmarks.agreement import Values
from benchmarks.capture_spreads import describe_light, measure_spreads
from benchmarks.constancy_table import format_table
from benchmarks.london_tones import know_wall, measure_london
from benchmarks.pair_rows import (
    compute_raw_angles,
    measure_colours,
    read_all_places,
    read_pairs,
    score_colours,
    score_linear_map,
    score_network,
    score_reading,
    score_regions,
)
from benchmarks.pigment_changes import KnownCrop, measure_slopes, remove_colour
from benchmarks.portrait_pairs import FOLDER, Person, read_people
from benchmarks.portraits import PIGMENTS, Portrait, measure_wall_reflectance, read_portraits
from benchmarks.reader import NetworkReader
from benchmarks.repeated_faces import RepeatedFaces
from benchmarks.report import Results, main
from benchmarks.second_source import list_second_source, read_degraded
from benchmarks.skin_readings import SkinReading, read_skin, stack_readings
from benchmarks.synthetic_constancy import measure_changes, measure_people
from benchmarks.white_balances import MISSING, keep, list_balances
from skinnet.errors import InputError
from skinnet.network import SkinAutoencoder
from train.people import read_index

FOURTH = Path(__file__).parent / "fourth.safetensors"

Readers = dict[str, NetworkReader]
"""The network that is measured, and the fourth."""


def measure(
    every: int = 1,
    weights: Path | None = None,
    folder: Path = FOLDER,
    synthetic: RepeatedFaces | None = None,
) -> Results:
    """Measure every figure, by network."""
    if not (folder / "congress_pairs" / "index.csv").is_file():
        raise InputError(f"{folder} has no congress_pairs/index.csv; put the portraits there.")
    readers = {
        name: NetworkReader(SkinAutoencoder.from_pretrained(path))
        for name, path in (("own", weights), ("fourth", FOURTH))
    }
    people = list(read_people(folder / "congress_pairs", every))
    london = list(read_portraits(sorted((folder / "london").glob("*.jpg"))[::every]))
    parts = [
        measure_pairs(people, readers),
        measure_guards([one for one in people if one.kept], london, readers),
        {name: {"london": measure_london(london, one)} for name, one in readers.items()},
        measure_rendered(synthetic or RepeatedFaces(), readers),
        measure_second_source(folder, readers, every),
    ]
    own, fourth, baselines = (_merge(parts, name) for name in ("own", "fourth", "baselines"))
    fourth = fourth.pop("pairs") | fourth
    return {**own, "baselines": {**baselines, "fourth": fourth}}


def _merge(parts: Sequence[Results], name: str) -> Results:
    found: Results = {}
    for part in parts:
        for key, value in part.get(name, {}).items():
            found[key] = found[key] | value if key in found else value
    return found


def measure_pairs(people: Sequence[Person], readers: Readers) -> Results:
    """Measure the pairs by every row; only the linear map sees people who are not kept."""
    kept = np.array([person.kept for person in people])
    tested = [person for person in people if person.kept]
    colours = measure_colours(people, keep)
    raw = compute_raw_angles(colours)
    found: Results = {"baselines": measure_baselines(tested, raw[kept])}
    targets: dict[str, Values] = {"angle": raw}
    for row, reader in readers.items():
        _log(f"Pairs are read by {row}.")
        reading = read_pairs(people, reader)
        for index, name in enumerate(PIGMENTS):
            targets[name if row == "own" else f"{name}_of_fourth"] = reading.pigments[..., index]
        chosen = _choose(reading, kept)
        score = score_network(chosen, reader.model.decoder, raw[kept])
        found[row] = {"pairs": score, "regions": score_regions(chosen)}
    found["baselines"]["linear_map"] = (
        None if kept.all() else score_linear_map(read_all_places(people), targets, kept, raw[kept])
    )
    found["own"]["captures"] = {"pairs": measure_spreads(describe_light(colours))}
    return found


def _choose(reading: SkinReading, kept: np.ndarray) -> SkinReading:
    regions = {name: values[kept] for name, values in reading.regions.items()}
    return SkinReading(reading.pigments[kept], reading.sd[kept], regions)


def measure_baselines(people: Sequence[Person], raw: Values) -> Results:
    """Measure the rows that have a colour and no network; a row that is not at hand says why."""
    return {
        name: {"missing": MISSING}
        if balance is None
        else score_colours(measure_colours(people, balance), raw)
        for name, balance in list_balances().items()
    }


def measure_guards(
    people: Sequence[Person], london: Sequence[Portrait], readers: Readers
) -> Results:
    """Measure whether it is the skin that is read."""
    found: Results = {}
    portraits = [KnownCrop(person.faces[0].crop) for person in people]
    wall = measure_wall_reflectance(london) if london else 1.0
    for row, reader in readers.items():
        _log(f"Guards of {row}.")
        known = [KnownCrop(one.crop, know_wall(one, reader, wall)) for one in london]
        editors = {"slope": reader}
        if row != "fourth":
            editors["slope_by_fourth"] = readers["fourth"]
        slopes = {
            way: {
                "blind": measure_slopes(portraits, reader, editor),
                "known": measure_slopes(known, reader, editor),
            }
            for way, editor in editors.items()
        }
        found[row] = {"guards": {"grey": measure_grey(people, reader), **slopes}}
    return found


def measure_grey(people: Sequence[Person], reader: NetworkReader) -> Results:
    """Measure the pairs in grey."""
    reading = stack_readings(
        stack_readings(read_skin(reader, remove_colour(face.crop)) for face in person.faces)
        for person in people
    )
    return score_reading(reading, reader.model.decoder)


def measure_rendered(settings: RepeatedFaces, readers: Readers) -> Results:
    """Measure rendered faces, whose pigments are known."""
    _log("Rendered faces.")
    scores, spreads = measure_people(settings, readers)
    slopes = measure_changes(settings, readers)
    found: Results = {
        row: {"synthetic": scores[row], "guards": {"slope_synthetic": slopes[row]}}
        for row in readers
    }
    found["own"]["captures"] = {settings.captures: spreads}
    return found


def measure_second_source(folder: Path, readers: Readers, every: int = 1) -> Results:
    """Measure two degradations of photographs of people who are not among the pairs."""
    found: Results = {row: {"second_source": {}} for row in readers}
    known = [row["person"] for row in read_index(folder / "congress_pairs")]
    for name, some in list_second_source(folder, known).items():
        _log(f"Second source: {name}.")
        pairs = list(read_degraded(some[::every]))
        if not pairs:
            continue
        others = [Person("", True, pair) for pair in pairs]
        colours = measure_colours(others, keep)
        raw = compute_raw_angles(colours)
        for row, reader in readers.items():
            score = score_network(read_pairs(others, reader), reader.model.decoder, raw)
            found[row]["second_source"][name] = score
        uncorrected = score_colours(colours, raw)
        found.setdefault("baselines", {}).setdefault("uncorrected", {})[name] = uncorrected
    return found


def _log(text: str) -> None:
    print(text, file=sys.stderr, flush=True)


if __name__ == "__main__":
    main(
        measure,
        __doc__ or "",
        format_table,
        paths={"weights": ".safetensors to measure instead of the shipped one"},
        counts={"every": "take every Nth person and face"},
    )
