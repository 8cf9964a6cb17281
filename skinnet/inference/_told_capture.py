"""What the options of a command tell of the capture of each photograph."""

import argparse
from typing import NamedTuple

from skinnet.images.picture import Picture
from skinnet.inference._capture_inputs import make_capture_inputs
from skinnet.inference._references.options import References, read_references
from skinnet.inference.capture import Capture
from skinnet.inference.capture_profile import CaptureProfile
from skinnet.inference.decomposer import Decomposer

_EXIF = "exif"
"""The value of --camera for the camera that the EXIF of each photograph names."""


class ToldCapture(NamedTuple):
    """The options, checked before any photograph is read.

    Attributes:
        references: References in the picture, and the profile of the session.
        named: Light and camera by their names.
        by_exif: Whether the camera is the one that EXIF names.
    """

    references: References
    named: Capture
    by_exif: bool

    @classmethod
    def from_options(
        cls, options: argparse.Namespace, decomposer: Decomposer, count: int
    ) -> "ToldCapture":
        """Check the options for a number of photographs.

        Raises:
            InputError: They are wrong, or do not go together.
        """
        references = read_references(options, count)
        by_exif = options.camera == _EXIF
        named = Capture.from_names(None if by_exif else options.camera, options.light)
        if any(part is not None for part in named):
            make_capture_inputs(named, decomposer.encoder)
        return cls(references, named, by_exif)

    def tell(self, picture: Picture) -> tuple[CaptureProfile | Capture, tuple[str, ...]]:
        """Tell what is known of a picture, and what the user should read.

        Raises:
            InputError: A reference in the picture cannot be used.
        """
        named, notes = self._name_camera(picture) if self.by_exif else (self.named, ())
        known, told = self.references.tell(picture, named)
        return known, (*notes, *told)

    def _name_camera(self, picture: Picture) -> tuple[Capture, tuple[str, ...]]:
        """Add the camera that EXIF names; or a note that it names none."""
        told = Capture.from_photograph(picture)
        if told.camera is None:
            note = "EXIF names no camera whose sensitivities are measured; it is read without."
            return self.named, (f"{picture.name}: {note}",)
        return self.named._replace(camera=told.camera), ()
