"""A capture profile, as it is used for one photograph."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from skinnet.images.picture import Picture
from skinnet.inference._references.balances import MOST_BLIND, format_balance, is_apart
from skinnet.inference.capture import Capture
from skinnet.inference.capture_profile import CaptureProfile
from skinnet.inference.decomposition import Decomposition


class Applied(NamedTuple):
    """A photograph as it is read, and what is known of it.

    Attributes:
        picture: The photograph, in linear light if its tone curve is known.
        capture: What is known of it, as it was given or by the profile.
        profile: The profile that holds for it; None if none was given.
        original: The photograph as it was.
    """

    picture: Picture
    capture: Any
    profile: CaptureProfile | None
    original: Picture

    def doubt(self, who: str, blind: Sequence[float], told: Sequence[float]) -> tuple[str, ...]:
        """Note that the white balance that is told does not fit what is seen without it."""
        if self.profile is not None and isinstance(self.capture, Capture):
            return self.profile.doubt(who, blind, self.capture)
        if not is_apart(blind, told, MOST_BLIND):
            return ()
        return (
            f"The white balance that was given for {who} is far from what is seen without it: log "
            f"R/G and log B/G are {format_balance(told)}, and not {format_balance(blind)}. Is the "
            "reference white or grey, and lit as the face is?",
        )

    def restore(self, decomposition: Decomposition) -> Decomposition:
        """Give a decomposition the photograph as it was, and its reconstruction these tones."""
        if self.profile is None or self.picture is self.original:
            return decomposition
        box = decomposition.box.slices
        picture = self.original.srgb.copy()
        read = decomposition.reconstruction[box]
        same = (read == self.picture.srgb[box]).all(-1, keepdims=True)
        picture[box] = np.where(same, picture[box], self.profile.restore(read))
        source = decomposition._source
        if source is not None:  # an edit is one of the photograph as it was
            source = source._replace(picture=self.original, outputs=None)
        return replace(decomposition, reconstruction=picture, _source=source)


def apply_profile(picture: Picture, capture: Any, is_read: bool = True) -> Applied:
    """Apply a capture profile to a photograph; anything else that is known is left as it is.

    Args:
        picture: The photograph.
        capture: What is known of it; None: nothing.
        is_read: Whether the photograph is read alone. An edit changes it as it is, so that its tone
            curve stays.

    Raises:
        InputError: The profile is of another kind of file.
    """
    if not isinstance(capture, CaptureProfile):
        return Applied(picture, capture, None, picture)
    profile, notes = capture.fit_to(picture)
    picture = replace(picture, notes=(*picture.notes, *notes))
    if not is_read:
        return Applied(picture, profile.capture, profile, picture)
    seen, known = profile.linearise(picture)
    return Applied(seen, known, profile, picture)
