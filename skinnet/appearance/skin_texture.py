"""The skin of one person over a texture space."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float32

from skinnet.appearance.colour import SkinColour
from skinnet.errors import InputError


@dataclass(frozen=True, eq=False)
class SkinTexture:
    """One person's skin over a square texture space; row 0 is the top.

    `f_mel` and `f_blood` [n, n] are volume fractions in [0, 1], `offset` [n, n, 3] linear RGB that
    skin does not explain (equation 9), and `mask` [n, n] says which texels are known; what the
    others hold does not count. Raises `InputError`, with the texture's `name`, for a known texel
    that is not finite or whose fraction lies outside [0, 1].
    """

    f_mel: Float32[np.ndarray, "size size"]
    f_blood: Float32[np.ndarray, "size size"]
    offset: Float32[np.ndarray, "size size 3"]
    mask: Bool[np.ndarray, "size size"]
    name: str = "texture"

    def __post_init__(self) -> None:
        for name in ("f_mel", "f_blood", "offset"):
            if not np.isfinite(values := getattr(self, name)[self.mask]).all():
                raise InputError(f"{self.name}: {name} has a known texel that is not finite.")
            if name != "offset" and not ((values >= 0) & (values <= 1)).all():
                worst = values[np.abs(values - 0.5).argmax()]
                raise InputError(
                    f"{self.name}: {name} is a volume fraction in [0, 1]; got {worst:g}. Was it "
                    "given in percent?"
                )

    def features(self) -> Float32[np.ndarray, "5 texels"]:
        """The features of every texel in the order of `CHANNELS`, 0 where unknown."""
        planes = np.stack([self.f_blood, self.f_mel, *np.moveaxis(self.offset, -1, 0)])
        known: Float32[np.ndarray, "5 texels"] = np.where(self.mask, planes, np.float32(0))
        return known.reshape(len(planes), -1)

    def albedo(self, colour: SkinColour) -> Float32[np.ndarray, "size size 3"]:
        """Linear RGB of the known texels, 0 elsewhere (equation 11)."""
        rgb = np.where(self.mask.ravel(), colour.decode(self.features()), np.float32(0))
        return np.ascontiguousarray(rgb.T.reshape(*self.mask.shape, 3))
