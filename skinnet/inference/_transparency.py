"""Skin that is transparent: its colour is mixed with white before it is read."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from skinnet.inference.decomposition import SKIN_THRESHOLD

_LEAST_SHARE, _OPAQUE = 0.02, 0.98
"""Share of skin that may be transparent without a note, as edges of a cut-out are, and the least
opacity of the rest."""


def note_transparency(
    alpha: NDArray[Any] | None, mask: NDArray[np.float32], name: str
) -> tuple[str, ...]:
    """Note that skin is transparent, from the opacity and the mask of the same part, [H, W]."""
    skin = mask > SKIN_THRESHOLD
    if alpha is None or not skin.any():
        return ()
    share = float(np.mean(alpha[skin] < _OPAQUE * np.iinfo(alpha.dtype).max))
    if share < _LEAST_SHARE:
        return ()
    return (
        f"{share:.0%} of the skin in {name} is transparent and was mixed with white, so that its "
        "pigments are read too low; give the picture without transparency.",
    )
