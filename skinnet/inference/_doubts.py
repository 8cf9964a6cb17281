"""Why what was read of a photograph should not be trusted, in words."""

import math
from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from skinnet.images._skin_colours import USUAL_RATIOS, measure_usual_squares
from skinnet.inference._uncertainty import find_factor
from skinnet.inference.decomposition import SKIN_THRESHOLD

_MELANIN_SPAN, _HEMOGLOBIN_SPAN = 3.0, 5.0
"""Ratios of the ends of a face's 90 % interval above which a pigment cannot be told."""

_COLOURED = 0.35
"""Error of log R/G or log B/G above which the light is strongly coloured."""

_TINTED = 10.0
"""Squared distance of the skin's colour from that of skin in portraits above which it is tinted:
6 of 231 portraits are beyond it: five are plainly warm, one is cold."""

_CASTS = ("red", "orange", "yellow", "green", "blue-green", "blue", "violet", "purple")
"""Casts by the angle of (Cr, -Cb), in eighths of a turn."""

_LITTLE_SKIN = 0.1
"""Share of skin in what was read below which there is little; portraits have 0.18 and more."""

_CLIPPED_SHARE = 0.1
"""Share of the skin that may be overexposed without a note."""

_DARK_SKIN = 0.12
"""Mean melanin from which on skin is dark. Without a known capture the typology angle of the
darkest group of London's portraits is read 30 degrees too high, and at half the exposure its
melanin, and not that of others, is read a third lower."""

_MOST_PIXELS = 1 << 20
"""Of larger photographs, every second pixel is looked at, or every third, and so on."""

_GIVE_WHITE = (
    "The colour of something white or grey in the photograph, such as a wall or a sheet of paper, "
    "tells the light: give its place by --white X,Y (in Python capture=Capture.from_reference)."
)
_GIVE_DAYLIGHT = "Give a photograph in daylight, without coloured light, filters or retouching."


def list_doubts(
    who: str,
    photo: NDArray[np.uint8],
    mask: NDArray[np.float32],
    outputs: Mapping[str, NDArray[np.float32]],
    known: Sequence[str],
    chromaticity: tuple[float, float] | None = None,
) -> tuple[str, ...]:
    """List all doubts about what was read.

    Args:
        who: What was read, such as "the face in a.jpg".
        photo: uint8 sRGB [H, W, 3], what was read of the photograph.
        mask: Probability of skin [H, W].
        outputs: Those of the encoder.
        known: Names of what was given of the capture.
        chromaticity: Log R/G and log B/G of the skin; None if they are not known.
    """
    little = note_little_skin(who, mask)
    if not (mask > SKIN_THRESHOLD).any():
        return little
    melanin, hemoglobin = outputs["face_sd"][0].tolist()
    balance = outputs["white_balance"][0].tolist()
    is_white_known = "white_balance" in known
    tint = None if is_white_known or chromaticity is None else find_tint(chromaticity)
    doubts = note_doubts(who, (melanin, hemoglobin), balance, is_white_known, tint)
    dark = note_dark_skin(who, outputs["melanin"][0], outputs["mask"][0])
    return (*little, *note_clipping(who, photo, mask), *dark, *doubts)


def note_doubts(
    who: str,
    face_sd: tuple[float, float],
    white_balance: Sequence[float],
    is_white_known: bool,
    tint: str | None = None,
) -> tuple[str, ...]:
    """Note what cannot be told, and what would help.

    Args:
        who: What was read, such as "the face in a.jpg".
        face_sd: Standard deviations of the natural logarithms of mean melanin and hemoglobin.
        white_balance: Natural logarithms of the error in R/G and in B/G.
        is_white_known: Whether the white balance was given.
        tint: The cast that `find_tint` finds; None if there is none.
    """
    doubts = []
    melanin, hemoglobin = (find_factor(sd) for sd in face_sd)
    if melanin**2 > _MELANIN_SPAN:
        doubts.append(
            f"Melanin cannot be told well from this photograph: that of {who} may be "
            f"{melanin:.2g} times higher or lower than what is read."
        )
    if hemoglobin**2 > _HEMOGLOBIN_SPAN:
        doubts.append(
            f"Hemoglobin cannot be told from this photograph: what is read of {who} is near that "
            "of people at large."
        )
    if tint is not None:
        doubts.append(
            f"The skin of {who} looks tinted {tint}, as by coloured light, a filter or a wrong "
            "white balance; the pigments are only as right as the guess of it."
        )
    elif not is_white_known and max(map(abs, white_balance)) > _COLOURED:
        doubts.append(
            f"The light on {who} is strongly coloured, or the camera's white balance is wrong; the "
            "pigments are only as right as the guess of it."
        )
    remedy = _GIVE_DAYLIGHT if is_white_known else _GIVE_WHITE
    return (*doubts, remedy) if doubts else ()


def find_tint(chromaticity: tuple[float, float]) -> str | None:
    """Name the cast of skin by its log R/G and log B/G; None if its colour is usual."""
    if measure_usual_squares(np.array([chromaticity]))[0] < _TINTED:
        return None
    red, blue = np.exp(np.array(chromaticity) - USUAL_RATIOS)
    cb, cr = 0.5 * blue - 0.169 * red - 0.331, 0.5 * red - 0.419 - 0.081 * blue
    return _CASTS[round(math.atan2(-cb, cr) / (math.pi / 4)) % len(_CASTS)]


def note_little_skin(who: str, mask: NDArray[np.float32]) -> tuple[str, ...]:
    """Note that there is hardly any skin, from the mask [H, W] of what was read."""
    share = float(np.mean(mask > SKIN_THRESHOLD))
    if share >= _LITTLE_SKIN:
        return ()
    if share == 0:
        return (f"No skin was found of {who}; give a picture in which nothing covers it.",)
    return (
        f"Nearly no skin of {who} was found: only {100 * share:.1g} % of what was read. Its means "
        "are those of this part, which may be something else; the mask shows where it is.",
    )


def note_dark_skin(
    who: str, melanin: NDArray[np.float32], mask: NDArray[np.float32]
) -> tuple[str, ...]:
    """Note that dark skin may be darker than it is read, from melanin and the mask [h, w]."""
    skin = melanin[mask > SKIN_THRESHOLD]
    if not skin.size or skin.mean() < _DARK_SKIN:
        return ()
    return (
        "Dark skin is often read as paler than it is, the more so in dark photographs: the melanin "
        f"of {who} may be above its interval. A photograph with a brighter exposure helps.",
    )


def note_clipping(who: str, photo: NDArray[np.uint8], mask: NDArray[np.float32]) -> tuple[str, ...]:
    """Note that skin is overexposed, from uint8 sRGB [H, W, 3] and the mask [H, W]."""
    step = max(1, math.isqrt(mask.size // _MOST_PIXELS))
    skin = photo[::step, ::step][mask[::step, ::step] > SKIN_THRESHOLD]
    share = float((skin == 255).any(-1).mean()) if skin.size else 0.0
    if share <= _CLIPPED_SHARE:
        return ()
    return (
        f"{share:.0%} of the skin of {who} is overexposed: its colour is lost, and its pigments "
        "are read too low. Give a photograph with a shorter exposure.",
    )
