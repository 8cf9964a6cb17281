"""What the options --white, --chart and --capture tell of the capture of a photograph."""

import argparse
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

from skinnet.errors import InputError
from skinnet.images.picture import Picture
from skinnet.inference._references.place import read_card, read_place
from skinnet.inference.capture import Capture
from skinnet.inference.capture_profile import CaptureProfile

_ONE_PICTURE = (
    "--white is a place in one picture, and {count} are given. Make a profile of one of them with "
    "`skinnet capture`, and give it to all by --capture."
)


class References(NamedTuple):
    """The options, checked.

    Attributes:
        place: Of the white reference; None if none is given.
        colour: Of the reference, as for `Capture.from_reference`.
        chart: `classic` or a file; None if none is given.
        profile: The profile; None if none is given.
    """

    place: tuple[int, ...] | None = None
    colour: float | tuple[int, ...] | None = None
    chart: str | None = None
    profile: CaptureProfile | None = None

    def tell(
        self, picture: Picture, named: Capture
    ) -> tuple[CaptureProfile | Capture, tuple[str, ...]]:
        """Tell what is known of a picture, and what the user should read.

        Args:
            picture: The picture.
            named: Light and camera by their names, which come first.

        Raises:
            InputError: A reference in the picture cannot be used.
        """
        known, notes = self._read(picture)
        return _adopt(known, named), notes

    def _read(self, picture: Picture) -> tuple[CaptureProfile | Capture, tuple[str, ...]]:
        if self.chart is not None:
            own = CaptureProfile.from_chart(picture, self.chart)
            if self.profile is None:
                return own, ()
            notes = self.profile.compare(own.white_balance, f"The chart in {picture.name}")
            return own, notes
        if self.place is None:
            return self.profile or Capture(), ()
        if self.profile is None:
            return Capture.from_reference(picture, self.place, self.colour), ()
        return self.profile.adopt_white(picture, self.place, self.colour)


def read_references(options: argparse.Namespace, count: int) -> References:
    """Read the options for a number of pictures, before any of them is read.

    Raises:
        InputError: They are wrong, or do not go together.
    """
    if options.white is None and options.white_colour is not None:
        raise InputError("--white-colour says what --white shows; give --white X,Y, too.")
    if options.white is not None and options.chart is not None:
        raise InputError("--white and --chart are both references; leave out one.")
    place = None if options.white is None else read_place(options.white)
    if place is not None and count > 1:
        raise InputError(_ONE_PICTURE.format(count=count))
    card = read_card(options.white_colour)
    path: Path | None = getattr(options, "capture", None)
    profile = None if path is None else CaptureProfile.load(path)
    return References(place, card.levels or card.reflectance, options.chart, profile)


def _adopt(known: CaptureProfile | Capture, named: Capture) -> CaptureProfile | Capture:
    """Replace light and camera by those that are named."""
    parts = {name: part for name, part in named._asdict().items() if part is not None}
    if "light" in parts:
        parts.setdefault("temperature", None)
    if isinstance(known, Capture):
        return known._replace(**parts)
    linear = known.linear_capture
    return replace(
        known,
        capture=known.capture._replace(**parts),
        linear_capture=None if linear is None else linear._replace(**parts),
    )
