"""Rows of the table of people in two photographs: colours, a linear map, and networks."""

from collections.abc import Sequence

import numpy as np
import torch
from numpy.typing import NDArray

from benchmarks.agreement import Values, compare_with_other, measure_agreement, measure_coverage
from benchmarks.colour_of_places import Matrix, map_to_other, measure_places
from benchmarks.face_photographs import describe_colour, measure_colour
from benchmarks.portrait_pairs import Person
from benchmarks.portraits import PIGMENTS
from benchmarks.reader import NetworkReader
from benchmarks.report import Results
from benchmarks.skin_readings import SkinReading, compute_angles, read_skin, stack_readings
from benchmarks.typology import compute_typology_angle
from benchmarks.white_balances import Balance
from skinnet.physics import SkinDecoder


def measure_colours(people: Sequence[Person], balance: Balance) -> NDArray[np.float64]:
    """Measure the median linear RGB of skin after a white balance [people, 2, 3]."""
    return np.array(
        [
            [measure_colour(balance(face.photo), face.skin) for face in person.faces]
            for person in people
        ]
    )


def compute_raw_angles(colours: NDArray[np.floating]) -> NDArray[np.float64]:
    """Typology angles of colours [..., 3], in degrees."""
    return compute_typology_angle(torch.from_numpy(colours)).double().numpy()


def score_colours(colours: NDArray[np.floating], raw: Values) -> Results:
    """Score colours [people, 2, 3]; `raw` are the angles of uncorrected pixels [people, 2]."""
    angle, described = compute_raw_angles(colours), describe_colour(colours)
    return {
        "angle": measure_agreement(angle),
        "log_rg": measure_agreement(described[..., 0]),
        "log_bg": measure_agreement(described[..., 1]),
        **compare_with_other(angle, raw),
    }


def read_all_places(people: Sequence[Person]) -> Matrix:
    """Measure the colours of places of people [people, 2, features]."""
    return np.array([[measure_places(face) for face in person.faces] for person in people])


def score_linear_map(
    places: Matrix, targets: dict[str, Values], kept: NDArray[np.bool_], raw: Values
) -> Results:
    """Score linear maps to each target on the kept people, fitted on the others.

    Args:
        places: Features of people, [people, 2, features].
        targets: Values by name, [people, 2]; one of them is `angle`.
        kept: Which people are kept, [people].
        raw: Angles of the uncorrected pixels of the kept people.
    """
    guesses = {
        name: map_to_other((places[~kept], target[~kept]), places[kept])
        for name, target in targets.items()
    }
    scores = {name: measure_agreement(guess) for name, guess in guesses.items()}
    return {**scores, **compare_with_other(guesses["angle"], raw)}


def read_pairs(people: Sequence[Person], reader: NetworkReader) -> SkinReading:
    """Read both photographs of people, with their regions."""
    return stack_readings(
        stack_readings(read_skin(reader, face.crop, face.find_regions()) for face in person.faces)
        for person in people
    )


def score_reading(reading: SkinReading, decoder: SkinDecoder) -> Results:
    """Score readings [people, 2] by pigment and angle, with what they state of the pigments."""
    found: Results = {}
    for index, name in enumerate(PIGMENTS):
        values, sd = reading.pigments[..., index], reading.sd[..., index]
        agreement = measure_agreement(values)
        coverage = {"coverage": measure_coverage(values, sd), "stated_sd": float(np.median(sd))}
        found[name] = None if agreement is None else agreement | coverage
    return {**found, "angle": measure_agreement(compute_angles(reading.pigments, decoder))}


def score_network(reading: SkinReading, decoder: SkinDecoder, raw: Values) -> Results:
    """Score readings of people beside the raw angles of the other photograph."""
    other = compare_with_other(compute_angles(reading.pigments, decoder), raw)
    return {**score_reading(reading, decoder), **other}


def score_regions(reading: SkinReading) -> Results:
    """Score each region by pigment."""
    return {
        region: {name: measure_agreement(values[..., index]) for index, name in enumerate(PIGMENTS)}
        for region, values in reading.regions.items()
    }
