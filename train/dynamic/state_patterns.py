"""Where blood goes in states of a face, and what is published of it.

Places and signs follow the sources; sizes are ours, unless a source is given for them.
"""

from typing import NamedTuple

import numpy as np
from jaxtyping import Float

Chart = Float[np.ndarray, "size size"]

_JIMENEZ = "Jimenez et al., ACM Transactions on Graphics 29, 2010"
_MARTINEZ = "Benitez-Quiroz, Srinivasan and Martinez, PNAS 115, 2018"


class Place(NamedTuple):
    """A part of the face: Gaussians about landmarks.

    Attributes:
        landmarks: Numbers of the landmarks in their middle; each has a Gaussian of its own.
        right: Standard deviation along the rows, in sides of the chart.
        down: The same along the columns.
        outward: Share of the way from the middle of the face by which it lies farther out.
    """

    landmarks: tuple[int, ...]
    right: float
    down: float
    outward: float = 0.0


PLACES = {
    "cheeks": Place((50, 280), 0.062, 0.055),
    "lower cheeks": Place((207, 427), 0.05, 0.06),
    "nose": Place((5, 4), 0.028, 0.035),
    "forehead": Place((151,), 0.12, 0.05),
    "temples": Place((162, 389), 0.04, 0.06),
    "ears": Place((234, 454), 0.045, 0.08, 0.22),
    "chin": Place((199,), 0.045, 0.035),
    "lips": Place((0, 17, 37, 267, 84, 314, 78, 308), 0.028, 0.016),
    "mouth": Place((164, 18, 216, 436), 0.04, 0.028),
    "eyelids": Place((159, 386, 145, 374), 0.035, 0.016),
    "throat": Place((152,), 0.14, 0.05, 0.45),
}


class Pattern(NamedTuple):
    """What a state does at an amount of 1.

    Attributes:
        everywhere: Log change of the local mean outside of the places.
        places: The same in the middle of each place.
        spread: Relative change of the local standard deviation, where the mean changes most.
        seconds: Time in which blood follows by 63 %.
        source: What is published, and what is ours.
    """

    everywhere: float
    places: dict[str, float]
    spread: float
    seconds: float
    source: str


PATTERNS = {
    "flush": Pattern(
        0.32,
        {"cheeks": 1.5, "lower cheeks": 0.95, "nose": 0.95, "forehead": 0.75, "ears": 1.3,
         "chin": 0.55, "lips": 0.3, "mouth": 0.15, "eyelids": 0.1, "throat": 0.6},
        0.2,
        8.0,
        "cheeks, ears, nose, forehead and throat redden, where vessels are wide and near the "
        "surface: Wilkin, Journal of the American Academy of Dermatology 19, 1988; sizes are ours: "
        "at half the amount cheeks have twice the blood, as in Figure 6 of Alotaibi & Smith 2017",
    ),
    "pallor": Pattern(
        -0.65,
        {"cheeks": -1.0, "nose": -0.8, "lips": -0.8, "ears": -0.9, "eyelids": -0.6,
         "forehead": -0.75},
        -0.25,
        4.0,
        f"less blood, after {_JIMENEZ}; that lips, cheeks and ears lose most, and sizes, are ours",
    ),
    "exertion": Pattern(
        0.6,
        {"cheeks": 1.35, "lower cheeks": 1.0, "nose": 0.85, "forehead": 0.9, "ears": 1.2,
         "temples": 0.8, "chin": 0.5, "lips": 0.3, "mouth": 0.02, "eyelids": 0.3,
         "throat": 0.8},
        0.1,
        16.0,
        f"blood after exercise was measured by {_JIMENEZ}; places and sizes are ours, as is the "
        "paler skin around the mouth",
    ),
    "joy": Pattern(
        0.0, {"cheeks": 0.35, "temples": 0.25, "chin": -0.15}, 0.05, 2.0,
        f"redder cheeks and temples, a paler chin: {_MARTINEZ}; sizes are ours",
    ),
    "surprise": Pattern(
        0.0, {"forehead": 0.3, "cheeks": -0.08, "mouth": -0.08}, 0.0, 2.0,
        f"a redder forehead: {_MARTINEZ}; the rest and sizes are ours",
    ),
    "disgust": Pattern(
        0.0, {"forehead": 0.25, "nose": 0.3, "mouth": -0.25, "lips": -0.2}, 0.0, 2.0,
        f"redder forehead and nose, paler skin around the lips: {_MARTINEZ}; sizes are ours",
    ),
    "anger": Pattern(
        0.2, {"forehead": 0.6, "cheeks": 0.6, "nose": 0.4, "ears": 0.6, "lips": -0.2}, 0.05,
        4.0,
        "faces redden with anger (Drummond, Psychophysiology 36, 1999); places and sizes are ours",
    ),
    "pulse": Pattern(
        0.035, {"cheeks": 0.05, "forehead": 0.05}, 0.0, 0.0,
        "2 to 5 % with each beat, most in forehead and cheeks: Verkruysse et al., Optics Express "
        "16, 2008",
    ),
}  # fmt: skip
"""Coefficients of the model beside the expressions."""

STATES: dict[str, dict[str, float]] = {
    "flush": {"flush": 1.0},
    "pallor": {"pallor": 1.0},
    "exertion": {"exertion": 1.0},
    "smile": {"joy": 1.0, "mouthSmile_L": 0.8, "mouthSmile_R": 0.8, "cheekSquint_L": 0.5,
              "cheekSquint_R": 0.5},
    "frown": {"anger": 0.4, "browDown_L": 0.9, "browDown_R": 0.9, "mouthFrown_L": 0.5,
              "mouthFrown_R": 0.5},
    "surprise": {"surprise": 1.0, "browInnerUp_L": 0.7, "browInnerUp_R": 0.7, "browOuterUp_L": 0.6,
                 "browOuterUp_R": 0.6, "jawOpen": 0.3},
    "disgust": {"disgust": 1.0, "noseSneer_L": 0.7, "noseSneer_R": 0.7},
    "anger": {"anger": 1.0, "browDown_L": 0.7, "browDown_R": 0.7},
    "pulse": {"pulse": 1.0},
}  # fmt: skip
"""The named states: the blood of an expression is that of the mood, and of skin that is moved."""

STRETCH_SOURCE = (
    "of an expression: skin that is stretched is paler, and skin that is pressed together redder, "
    "by the square root of its area; areas are those of ICT-FaceKit's shapes, the law is ours"
)


ORIGIN = (
    "python -m train.dynamic, from synthetic faces and the places that the sources name; no "
    "photograph, scan or measured face is in it. MIT licence, as the code"
)


def draw_pattern(
    pattern: Pattern, landmarks: Float[np.ndarray, "478 2"], size: int
) -> tuple[Chart, Chart]:
    """Draw the changes of mean and spread on a chart, [size, size] both."""
    line = (np.arange(size) + 0.5) / size
    x, y = np.meshgrid(line, line)
    shares = {name: _draw_place(PLACES[name], landmarks, x, y) for name in pattern.places}
    background = 0.5
    total = sum(shares.values(), np.full((size, size), background))
    mean = np.full((size, size), background * pattern.everywhere)
    for name, share in shares.items():
        mean += share * pattern.places[name]
    mean /= total
    strongest = np.abs(mean).max()
    return mean, pattern.spread * np.abs(mean) / strongest


def _draw_place(place: Place, landmarks: Float[np.ndarray, "478 2"], x: Chart, y: Chart) -> Chart:
    """The share of a place at each texel: it outweighs the background tenfold in its middle."""
    middle = landmarks[[10, 152, 234, 454]].mean(0)
    spots = []
    for number in place.landmarks:
        column, row = landmarks[number] + place.outward * (landmarks[number] - middle)
        square = ((x - column) / place.right) ** 2 + ((y - row) / place.down) ** 2
        spots.append(5 * np.exp(-0.5 * square))
    return np.asarray(np.max(spots, 0))
