"""What is known of the light and the camera of a session, from a picture of a chart or a card."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from skinnet.errors import InputError, _explain_fault
from skinnet.files import write_text
from skinnet.images.photograph import read_picture
from skinnet.images.picture import Picture
from skinnet.inference._references.balances import (
    MOST_APART,
    MOST_BLIND,
    format_balance,
    is_apart,
)
from skinnet.inference._references.chart import CLASSIC, load_chart
from skinnet.inference._references.linearisation import linearise, restore_tones
from skinnet.inference._references.profile_text import ProfileContent, format_profile, parse_profile
from skinnet.inference._references.shot_settings import ShotSettings, read_settings
from skinnet.inference._references.tone_curve import ToneCurve
from skinnet.inference.capture import Capture

_RAW = "RAW"
"""Format of pictures that are linear."""

_MOST_STOPS = 0.1
"""Difference of exposure, in stops, from which the exposure of a profile does not hold."""


@dataclass(frozen=True)
class CaptureProfile:
    """Light, camera and tone curve of a session of photographs.

    A `Decomposer` takes it as `capture`. If the tone curve is known, it is undone before the
    photograph is read. It holds for photographs of the same camera, in the same light, with the
    same settings; white balance and exposure must be set by hand.

    Attributes:
        capture: What is known of the photographs as they are.
        linear_capture: What is known of them after their tone curve is undone; None if that is not
            known, or if they are linear already.
        tone: The tone curve; None if it is not known, or there is none.
        correction: The chart's correction, from linear light to linear sRGB under D65 [3, 3]:
            colour @ correction; None without a chart.
        delta_e: Mean and largest CIEDE2000 of the patches after the correction; None without one.
        source: Name of the picture, and what was in it: `white`, `classic`, or a CSV file.
        settings: Camera and exposure of the picture by its EXIF.
        format: Format of the picture's file.

    Example:
        >>> import numpy as np
        >>> from skinnet.inference import CaptureProfile
        >>> card = np.full((40, 60, 3), (150, 140, 120), np.uint8)
        >>> profile = CaptureProfile.from_white(card, (30, 20), 0.18)
        >>> [round(value, 2) for value in profile.capture.white_balance]
        [0.11, -0.17]
    """

    capture: Capture
    linear_capture: Capture | None = None
    tone: ToneCurve | None = None
    correction: tuple[tuple[float, ...], ...] | None = None
    delta_e: tuple[float, float] | None = None
    source: tuple[str, str] = ("", "white")
    settings: ShotSettings = ShotSettings()
    format: str = ""

    @classmethod
    def from_chart(cls, image: Any, chart: str | Path = CLASSIC) -> "CaptureProfile":
        """Read a colour chart in a picture.

        Args:
            image: A path, a Pillow image, an array or a `Picture`.
            chart: `classic` for the ColorChecker Classic and Passport, or a CSV file of a chart's
                patches: the columns row and column, from 1, and either L, a and b (CIE L*a*b* under
                D50) or reflectances in [0, 1] at wavelengths in nm, which name their columns.

        Returns:
            White balance, exposure and tone curve; light and camera, too, if the spectra of the
            patches are known and explain the picture.

        Raises:
            InputError: The picture cannot be read; the chart is not found, cut, overexposed, too
                dark, not in one light, or another one; or the extra `chart` is not installed.
        """
        # Not at start-up: fits take scipy.optimize, and most photographs come without a chart.
        from skinnet.inference._references.chart_reading import read_chart

        picture = read_picture(image)
        reading = read_chart(picture, load_chart(chart))
        plain = reading.tone == ToneCurve()
        rows = tuple(tuple(round(float(one), 5) for one in row) for row in reading.correction)
        worst = float(np.nanmean(reading.delta_e)), float(np.nanmax(reading.delta_e))
        return cls(
            _round(reading.capture),
            None if plain else _round(reading.linear_capture),
            None if plain else ToneCurve(*(round(one, 5) for one in reading.tone)),
            rows,
            (round(worst[0], 2), round(worst[1], 2)),
            (Path(picture.name).name, Path(chart).name),
            read_settings(picture),
            picture.format,
        )

    @classmethod
    def from_white(
        cls,
        image: Any,
        place: Sequence[int],
        colour: float | Sequence[int] | None = None,
    ) -> "CaptureProfile":
        """Measure something white or grey, or of a known colour, in a picture.

        Args:
            image: A path, a Pillow image, an array or a `Picture`.
            place: Where it is: (x, y), or a box (x0, y0, x1, y1), in pixels from the upper left
                corner of the upright picture.
            colour: Its reflectance in [0.01, 1], or its sRGB in integers of 0 to 255; None for
                something white or grey.

        Returns:
            The white balance, and the exposure if `colour` is given.

        Raises:
            InputError: As `Capture.from_reference`.
        """
        picture = read_picture(image)
        return cls(
            _round(Capture.from_reference(picture, place, colour)),
            source=(Path(picture.name).name, "white"),
            settings=read_settings(picture),
            format=picture.format,
        )

    @classmethod
    def load(cls, path: str | Path) -> "CaptureProfile":
        """Load a profile from a YAML file.

        Args:
            path: The file.

        Returns:
            The profile.

        Raises:
            InputError: It is missing, or not a profile.
        """
        content = parse_profile(Path(path))
        return cls(**content._asdict())

    def save(self, path: str | Path) -> None:
        """Write the profile as a YAML file.

        Args:
            path: The file, whose name ends in .yaml or .yml; an older file is replaced.

        Raises:
            InputError: The name has another ending, or the file cannot be written.
        """
        target = Path(path)
        if target.suffix.lower() not in (".yaml", ".yml"):
            raise InputError(f"A capture profile is a .yaml file; got {target}.")
        content = ProfileContent(*(getattr(self, name) for name in ProfileContent._fields))
        try:
            write_text(target, format_profile(content))
        except OSError as error:
            raise InputError(f"{target} cannot be written {_explain_fault(error)}.") from error

    @property
    def light(self) -> Any:
        """Weights of lights, as of `Capture`."""
        return self.capture.light

    @property
    def temperature(self) -> float | None:
        """Colour temperature of the daylight, in kelvin."""
        return self.capture.temperature

    @property
    def camera(self) -> Any:
        """Coefficients of the camera basis."""
        return self.capture.camera

    @property
    def white_balance(self) -> Any:
        """Logarithms of the error in R/G and in B/G."""
        return self.capture.white_balance

    @property
    def linear(self) -> bool | None:
        """Whether photographs are linear as they are."""
        return self.capture.linear

    @property
    def exposure(self) -> float | None:
        """Logarithm of the luminance of white."""
        return self.capture.exposure

    def fit_to(self, picture: Picture) -> tuple["CaptureProfile", tuple[str, ...]]:
        """Leave out what does not hold for a picture, by what its file states.

        Args:
            picture: A photograph of the session.

        Returns:
            The profile that holds for it, and sentences that the user should read.

        Raises:
            InputError: The profile is that of a RAW file and the picture is none, or the reverse.
        """
        if (self.format == _RAW) != (picture.format == _RAW) and self.format and picture.format:
            raise InputError(
                f"The capture profile was made from a {self.format} file ({self.source[0]}), and "
                f"{picture.name} is a {picture.format} file; make a profile from a "
                f"{picture.format} file of the session."
            )
        own = read_settings(picture)
        profile, notes = self, []
        if None not in (own.camera, self.settings.camera) and own.camera != self.settings.camera:
            notes.append(
                f"{picture.name} is from a {own.camera} and the capture profile from a "
                f"{self.settings.camera}; another camera has other colours. Make a profile with it."
            )
        value, profiled = own.exposure_value, self.settings.exposure_value
        if value is not None and profiled is not None and abs(value - profiled) > _MOST_STOPS:
            profile = self._leave_out_exposure()
            notes.append(
                f"{picture.name} was exposed otherwise than the capture profile's picture (time, "
                "aperture or sensitivity); the exposure is taken as not known."
            )
        return profile, tuple(notes)

    def adopt_white(
        self, picture: Picture, place: Sequence[int], colour: float | Sequence[int] | None = None
    ) -> tuple["CaptureProfile", tuple[str, ...]]:
        """Replace white balance and exposure by those of a reference in a picture.

        Args:
            picture: The photograph.
            place: Where the reference is, as for `from_white`.
            colour: What it is, as for `from_white`.

        Returns:
            The profile, and a sentence if the reference is in another light than the profile.

        Raises:
            InputError: As `Capture.from_reference`.
        """
        own = _round(Capture.from_reference(picture, place, colour))
        notes = self.compare(own.white_balance, f"The white reference in {picture.name}")
        linear = self.linear_capture
        if linear is not None and self.tone is not None:
            straight = Capture.from_reference(linearise(picture, self.tone), place, colour)
            linear = linear._replace(
                white_balance=straight.white_balance, exposure=straight.exposure
            )
        capture = self.capture._replace(white_balance=own.white_balance, exposure=own.exposure)
        return replace(self, capture=capture, linear_capture=linear), notes

    def linearise(self, picture: Picture) -> tuple[Picture, Capture]:
        """Undo the tone curve of a photograph.

        Args:
            picture: A photograph of the session.

        Returns:
            The photograph in linear light, encoded as sRGB, and what is known of it. If the tone
            curve is not known, both are as they are.
        """
        if self.tone is None or self.linear_capture is None:
            return picture, self.capture
        return linearise(picture, self.tone), self.linear_capture

    def restore(self, reconstruction: NDArray[np.uint8]) -> NDArray[np.uint8]:
        """Apply the tone curve to a reconstruction of a photograph in linear light.

        Args:
            reconstruction: uint8 sRGB [H, W, 3].

        Returns:
            uint8 sRGB [H, W, 3].
        """
        return reconstruction if self.tone is None else restore_tones(reconstruction, self.tone)

    def doubt(self, who: str, blind: Sequence[float], known: Capture) -> tuple[str, ...]:
        """Note that a photograph does not look as if it were in the profile's light.

        Args:
            who: What was read, such as "the face in a.jpg".
            blind: White balance that is read without the profile.
            known: What the profile says of the photograph that was read.

        Returns:
            A sentence, or none.
        """
        if known.white_balance is None or not is_apart(blind, known.white_balance, MOST_BLIND):
            return ()
        told, seen = format_balance(known.white_balance), format_balance(blind)
        return (
            f"The capture profile ({self.source[0]}) seems to be from another light or white "
            f"balance than {who}: its log R/G and log B/G are {told}, and what is seen without it "
            f"{seen}. Make a profile in this light.",
        )

    def compare(self, own: Any, who: str) -> tuple[str, ...]:
        """Note that a picture's own reference is in another light than the profile.

        Args:
            own: White balance by the reference.
            who: The beginning of a sentence, such as "The chart in a.jpg".

        Returns:
            A sentence, or none.
        """
        if self.white_balance is None or not is_apart(own, self.white_balance, MOST_APART):
            return ()
        seen, told = format_balance(own), format_balance(self.white_balance)
        return (
            f"{who} has log R/G and log B/G of {seen}, and the capture profile ({self.source[0]}) "
            f"{told}: it is from another light or white balance. The reference in the picture is "
            "used.",
        )

    def _leave_out_exposure(self) -> "CaptureProfile":
        linear = self.linear_capture
        return replace(
            self,
            capture=self.capture._replace(exposure=None),
            linear_capture=None if linear is None else linear._replace(exposure=None),
        )


def _round(capture: Capture) -> Capture:
    """A capture as a file holds it, with four digits."""
    parts = capture._asdict()
    for name in ("camera", "white_balance"):
        if parts[name] is not None:
            parts[name] = tuple(round(float(one), 4) for one in parts[name])
    for name, digits in (("temperature", 0), ("exposure", 4)):
        if parts[name] is not None:
            parts[name] = round(float(parts[name]), digits)
    return Capture(**parts)
