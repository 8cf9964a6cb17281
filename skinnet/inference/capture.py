"""What a user knows of how a photograph was taken."""

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from skinnet.errors import InputError
from skinnet.images._arguments import check_number, check_text
from skinnet.images._picture_sources import PictureSource
from skinnet.images._raw.cameras import find_camera, list_close_names
from skinnet.images._raw.raw_file import FORMAT as RAW
from skinnet.images._shot import read_shot
from skinnet.images.photograph import read_picture
from skinnet.images.srgb import LUMINANCE_WEIGHTS, srgb_to_linear
from skinnet.inference._light_names import find_light
from skinnet.inference._references.place import (
    Card,
    Sample,
    make_card,
    measure_colour,
    name_reference,
)

_TO_CAMERA = np.array(
    (
        (0.540070474, 0.361235976, 0.098693445),
        (0.050515458, 0.726624548, 0.222859979),
        (0.002372061, 0.270590574, 0.727037191),
    )
)
"""Linear sRGB to the balanced channels of the mean camera in `SpectralCamera`."""

_CLIPPED, _DARK = 250, 20
"""Levels of 255 from which a channel is overexposed, and below which a colour is mostly noise."""

_MOST_COLOURED = 0.9
"""Largest norm of log R/G and log B/G, in the camera's channels, of something white under any
light and camera that photographs are taken with; only coloured things have more."""

_LEAST = 1e-3
"""Smallest value of a channel whose logarithm is taken, as in the network."""


class Capture(NamedTuple):
    """What is known of the light and the camera of a photograph; None is what is not known.

    `skinnet.physics.Capture` has the same fields as tensors, and may be given instead.

    Attributes:
        light: Weights of lights by the names in `OnnxModel.lights`, or a sequence of all weights in
            that order. They are divided by their sum.
        temperature: Colour temperature of the daylight among them, 4,000 to 25,000 K.
        camera: Coefficients of the camera basis, in standard deviations.
        white_balance: Natural logarithm of the error in R/G and in B/G, in the camera's channels.
        linear: Whether the picture is in linear light, such as a RAW file that was developed
            without a tone curve.
        exposure: Natural logarithm of the luminance, in linear sRGB, that a white diffuser in the
            light of the skin has in the photograph.

    Example:
        >>> from skimage.data import astronaut
        >>> from skinnet import Decomposer
        >>> from skinnet.inference import Capture
        >>> flash = Capture(light={"D": 1.0}, temperature=5500.0)
        >>> Decomposer(threads=1)(astronaut(), detail=False, capture=flash).capture_known
        ('light', 'temperature')
    """

    light: Mapping[str, float] | Sequence[float] | NDArray[Any] | None = None
    temperature: float | None = None
    camera: Sequence[float] | NDArray[Any] | None = None
    white_balance: Sequence[float] | NDArray[Any] | None = None
    linear: bool | None = None
    exposure: float | None = None

    @classmethod
    def from_names(cls, camera: str | None = None, light: str | None = None) -> "Capture":
        """Find camera and light by their names.

        Args:
            camera: One of the 52 measured cameras, by a name that its maker or EXIF gives it, in
                any case, such as "Nikon D700".
            light: Daylight of a temperature (D65, D5500K, 5500K), daylight (of any temperature),
                flash (as D5500K), tungsten (as A), or a name in `OnnxModel.lights`, such as FL2.

        Returns:
            A capture of which the coefficients of the camera, the light, and its temperature if the
            name has one, are known.

        Raises:
            InputError: The camera is not among those measured; the nearest names are given. Or
                daylight has no such temperature. Other lights are checked when they are used.

        Example:
            >>> from skinnet.inference import Capture
            >>> capture = Capture.from_names("nikon d700", "D5500K")
            >>> capture.light, capture.temperature, len(capture.camera)
            ({'D': 1.0}, 5500.0, 6)
        """
        for what, word in (("camera", camera), ("light", light)):
            if word is not None:
                check_text(f"The name of a {what}", word)
        found = find_camera(camera) if camera is not None else None
        if camera is not None and found is None:
            raise InputError(
                f"The camera {camera!r} is not among those whose sensitivities are measured; the "
                f"nearest names are {', '.join(list_close_names(camera))}. Leave it out if it is "
                "none of them."
            )
        name, temperature = (None, None) if light is None else find_light(light)
        return cls(
            light=None if name is None else {name: 1.0},
            temperature=temperature,
            camera=None if found is None else found.coefficients,
        )

    @classmethod
    def from_photograph(cls, image: PictureSource) -> "Capture":
        """Find what a photograph itself tells of its capture.

        `Decomposer` does this for RAW files, which are developed as training does it. It does not
        for others, since EXIF does not tell what was done to the colours after the sensor.

        Args:
            image: A photograph as for `Decomposer`.

        Returns:
            A capture whose camera is known if EXIF names one of the measured cameras, and which is
            known to be linear if it is a RAW file.

        Raises:
            InputError: The photograph cannot be read.

        Example:
            >>> from skimage.data import astronaut
            >>> from skinnet.inference import Capture
            >>> Capture.from_photograph(astronaut()) == Capture()  # an array has no EXIF
            True
        """
        picture = read_picture(image)
        camera = find_camera(read_shot(picture.metadata.get("exif", b"")).camera or "")
        return cls(
            camera=None if camera is None else camera.coefficients,
            linear=True if picture.format == RAW else None,
        )

    @classmethod
    def from_white(
        cls,
        colour: Sequence[Any] | NDArray[Any],
        reflectance: float | None = None,
    ) -> "Capture":
        """Find the white balance by the colour of something white or grey in the photograph.

        It must be lit as the face is, such as a sheet of paper beside it, a grey card, or a wall.

        Args:
            colour: sRGB [3] as the photograph shows it: integers in [0, 255], or floats in [0, 1].
            reflectance: How much of the light it reflects, in (0, 1]: a grey card .18, paper about
                .85. With it the exposure is known, too; None: it is not known.

        Returns:
            A capture of which the white balance is known, and the exposure if the reflectance is.

        Raises:
            InputError: It is not a colour, or it is overexposed, too dark, or not white or grey; or
                no reflectance.

        Example:
            >>> from skinnet.inference import Capture
            >>> capture = Capture.from_white((220, 200, 170))  # in warm light
            >>> [round(value, 2) for value in capture.white_balance]
            [0.15, -0.19]
        """
        display = _read_colour(colour)
        is_clipped = 255 * display.max() >= _CLIPPED
        clipped = f": {_CLIPPED} or more of 255 hides its true colour" if is_clipped else ""
        return _find_balance(Sample(display, name_reference(display), clipped), Card(reflectance))

    @classmethod
    def from_reference(
        cls,
        image: PictureSource,
        place: Sequence[int],
        colour: float | Sequence[int] | None = None,
    ) -> "Capture":
        """Measure something white or grey, or of a known colour, at a place of a photograph.

        Args:
            image: A photograph, as for `Decomposer`.
            place: Where it is: (x, y), or a box (x0, y0, x1, y1), in pixels from the upper left
                corner of the upright photograph.
            colour: Its reflectance in [0.01, 1], or its sRGB in integers of 0 to 255, as its maker
                states it; None for something white or grey.

        Returns:
            A capture of which the white balance is known, and the exposure if `colour` is given.

        Raises:
            InputError: The photograph cannot be read; the place is not in it; or what is there is
                overexposed, too dark, uneven, or more coloured than a light makes of it.

        Example:
            >>> from skimage.data import astronaut
            >>> from skinnet.inference import Capture
            >>> capture = Capture.from_reference(astronaut(), (300, 20, 320, 40))  # the wall
            >>> len(capture.white_balance), capture.exposure is None
            (2, True)
        """
        picture = read_picture(image)
        is_row = isinstance(place, np.ndarray) and place.ndim == 1
        if not is_row and (not isinstance(place, Sequence) or isinstance(place, str)):
            raise InputError(f"A place is (x, y) or (x0, y0, x1, y1) in pixels; got {place!r:.60}.")
        card = make_card(colour)
        return _find_balance(measure_colour(picture, tuple(place)), card)

    @classmethod
    def from_chart(
        cls,
        image: PictureSource,
        chart: str | Path = "classic",
    ) -> "Capture":
        """Read the colour chart in a photograph.

        `CaptureProfile.from_chart` finds the tone curve, too, and undoes it.

        Args:
            image: A photograph, as for `Decomposer`.
            chart: `classic`, or a CSV file, as for `CaptureProfile.from_chart`.

        Returns:
            White balance and exposure; light and camera, too, if they are told.

        Raises:
            InputError: As `CaptureProfile.from_chart`.
        """
        from skinnet.inference.capture_profile import CaptureProfile

        return CaptureProfile.from_chart(image, chart).capture


def _find_balance(sample: Sample, card: Card) -> Capture:
    """Find white balance and exposure by a reference.

    Raises:
        InputError: It is too dark, coloured or overexposed, or no reflectance.
    """
    linear = srgb_to_linear(sample.display).astype(np.float64)
    own = np.ones(3) if card.colour is None else np.array(card.colour)
    channels = np.log(np.maximum(_TO_CAMERA @ linear, _LEAST)) - np.log(_TO_CAMERA @ own)
    red, green, blue = channels.tolist()
    balance = red - green, blue - green
    _refuse_unfit(sample, balance, card)
    bright = card.reflectance if card.colour is None else min(1.0, float(own @ LUMINANCE_WEIGHTS))
    return Capture(white_balance=balance, exposure=_find_exposure(linear, bright))


def _find_exposure(linear: NDArray[np.float64], reflectance: float | None) -> float | None:
    if reflectance is None:
        return None
    reflectance = check_number("reflectance of a white reference", reflectance)
    if not 0.01 <= reflectance <= 1:
        raise InputError(
            f"reflectance of a white reference is a share in [0.01, 1]; got {reflectance:g}. A "
            "grey card has 0.18, white paper about 0.85."
        )
    return math.log(float(linear @ LUMINANCE_WEIGHTS) / reflectance)


def _read_colour(colour: Any) -> NDArray[np.float64]:
    """The colour as display sRGB [3] in [0, 1]."""
    try:
        values = np.asarray(colour)
    except ValueError:  # rows of different lengths
        values = np.empty(0)
    if values.shape != (3,) or values.dtype.kind not in "iuf":
        raise InputError(
            f"A white reference is one colour: red, green and blue. Got {colour!r:.80}; give the "
            "mean of its pixels."
        )
    top = 1.0 if values.dtype.kind == "f" else 255.0
    display = values.astype(np.float64) / top
    if not ((display >= 0) & (display <= 1)).all():
        raise InputError(
            "A white reference is sRGB in integers of 0 to 255, or in floats of 0 to 1; got "
            f"({', '.join(f'{value:g}' for value in values.tolist())})."
        )
    return display


def _refuse_unfit(sample: Sample, balance: tuple[float, float], card: Card) -> None:
    """Refuse what is dark, then what is coloured: more exposure would not help that."""
    if 255 * sample.display.max() < _DARK:
        raise InputError(
            f"{sample.name} is too dark: below {_DARK} of 255 its colour is noise. Choose "
            "something brighter in the light that falls on the face."
        )
    if math.hypot(*balance) > _MOST_COLOURED:
        what, remedy = (
            ("is coloured", "Choose something white or grey.")
            if card.colour is None
            else ("has not the colour that was given", "Check its place and that colour.")
        )
        over = " It is overexposed, too." if sample.clipped else ""
        raise InputError(
            f"{sample.name} {what}: its log R/G and log B/G are {balance[0]:.2f} and "
            f"{balance[1]:.2f}, and {_MOST_COLOURED:g} is the most that light makes of white."
            f"{over} {remedy}"
        )
    if sample.clipped:
        raise InputError(
            f"{sample.name} is overexposed{sample.clipped}. Choose a darker part of it, or "
            "something grey."
        )
