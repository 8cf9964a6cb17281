"""The skin of one person over a texture space."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float32

from skinnet.appearance.colour import SkinColour
from skinnet.errors import InputError


@dataclass(frozen=True, eq=False)
class SkinTexture:
    """One person's skin over a square texture space; row 0 is the top.

    Args:
        f_mel: Volume fraction of melanosomes, in [0, 1].
        f_blood: Volume fraction of blood, in [0, 1].
        offset: Linear RGB that the pigments do not explain.
        mask: Which texels are known; the values of the others are ignored.
        name: What error messages call the texture.

    Raises:
        InputError: If a known texel is not finite or its fraction lies outside [0, 1].

    Source:
        Section 4.4 and Equation 9 of Alotaibi & Smith 2017.

    Example:
        >>> level, known = np.full((2, 2), 0.05, np.float32), np.ones((2, 2), bool)
        >>> texture = SkinTexture(level, level, np.zeros((2, 2, 3), np.float32), known)
        >>> texture.features().shape
        (5, 4)
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
        """Stack [f_blood, f_mel, dR, dG, dB] of every texel (Equation 9 of Alotaibi & Smith 2017).

        Returns:
            Features in the order of `CHANNELS`, row by row, 0 where a texel is unknown.
        """
        planes = np.stack([self.f_blood, self.f_mel, *np.moveaxis(self.offset, -1, 0)])
        known: Float32[np.ndarray, "5 texels"] = np.where(self.mask, planes, np.float32(0))
        return known.reshape(len(planes), -1)

    def albedo(self, colour: SkinColour) -> Float32[np.ndarray, "size size 3"]:
        """Compute the linear RGB of the known texels (Equation 11 of Alotaibi & Smith 2017).

        Args:
            colour: Light, camera and calibration of the albedo.

        Returns:
            Linear RGB, 0 where a texel is unknown.
        """
        rgb = np.where(self.mask.ravel(), colour.decode(self.features()), np.float32(0))
        return np.ascontiguousarray(rgb.T.reshape(*self.mask.shape, 3))
