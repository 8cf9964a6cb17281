"""What the options --white, --chart and --capture tell of the capture of a photograph."""

import argparse
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

    def tell(self, picture: Picture) -> tuple[CaptureProfile | Capture | None, tuple[str, ...]]:
        """Tell what is known of a picture, and what the user should read.

        Raises:
            InputError: A reference in it cannot be used.
        """
        if self.chart is not None:
            own = CaptureProfile.from_chart(picture, self.chart)
            if self.profile is None:
                return own, ()
            notes = self.profile.compare(own.white_balance, f"The chart in {picture.name}")
            return own, notes
        if self.place is None:
            return self.profile, ()
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
