"""What a texture shows beside an albedo: normals, data, baked highlights, no skin."""

import numpy as np
from jaxtyping import Float32, Shaped

from skinnet.errors import InputError
from skinnet.material.albedo import AlbedoMaps
from skinnet.physics.inversion import F_BLOOD_RANGE

_STEP = 7
"""Every seventh texel of a strip is looked at."""

_WHITER = 0.05
"""Linear RGB by which a highlight is brighter than skin in all channels."""

_SOME, _MUCH, _MOST, _ALMOST_ALL = 0.002, 0.25, 0.5, 0.97
_LEAST_BLOOD, _MOST_BLOOD = 1e-5, 0.999 * F_BLOOD_RANGE[1]
_BLACK = 1e-3


class TextureCounts:
    """Counts over the texels of a texture, for what it shows."""

    def __init__(self) -> None:
        self._counts = np.zeros(7)

    def add(
        self,
        encoded: Float32[np.ndarray, "texels 3"],
        maps: AlbedoMaps,
        opaque: Shaped[np.ndarray, "texels"],
    ) -> None:
        """Count the texels of a strip, whose stored values are `encoded`, white being 1."""
        colours, place = encoded[::_STEP], opaque[::_STEP] > 0
        place &= (colours > _BLACK).any(-1)
        normal = np.abs(np.linalg.norm(2 * colours - 1, axis=-1) - 1) < 0.06
        normal &= colours[:, 2] > 0.48
        grey = np.ptp(colours, axis=-1) < 1e-6
        whiter = maps.offset[::_STEP].min(-1) > _WHITER
        skin = maps.skin[::_STEP] > 0
        blood = maps.f_blood[::_STEP]
        bound = skin & ((blood < _LEAST_BLOOD) | (blood > _MOST_BLOOD))
        flags = (np.ones_like(place), normal, grey, whiter, skin, bound)
        counts = [(flag & place).sum() for flag in flags]
        self._counts += [*counts, (~np.isfinite(encoded).all(-1)).sum()]

    def check(self, name: str) -> list[str]:
        """Check what was counted.

        Returns:
            Sentences that the user should read.

        Raises:
            InputError: The texture is no albedo.
        """
        if not self._counts[0]:
            raise InputError(f"{name} is black or transparent everywhere; give the albedo.")
        normal, grey, whiter, skin, bound = self._counts[1:6] / self._counts[0]
        if grey > _ALMOST_ALL:
            raise InputError(
                f"{name} is grey, as roughness, height and masks are; give the texture of the "
                "colour (albedo, base colour or diffuse)."
            )
        if normal > _ALMOST_ALL and skin < _MOST:
            raise InputError(
                f"{name} looks like a normal map: its colours are directions; give the texture of "
                "the colour (albedo, base colour or diffuse)."
            )
        said = [*self._describe_skin(name, skin), *self._describe_highlights(name, whiter)]
        return [*said, *self._describe_bound(name, bound, skin), *self._describe_unknown(name)]

    def _describe_unknown(self, name: str) -> list[str]:
        count = int(self._counts[6])
        if not count:
            return []
        return [
            f"{name}: {count:,} texels are not numbers, or infinite; they count as no skin and "
            "stay as they are."
        ]

    @staticmethod
    def _describe_skin(name: str, skin: float) -> list[str]:
        if skin >= _MOST:
            return []
        return [
            f"{name}: {1 - skin:.0%} of the texels have a colour that skin does not have under "
            "this light and camera; they stay as they are. If they are skin, name the light and "
            "the camera, or fit them: --calibration exposure, or full."
        ]

    @staticmethod
    def _describe_highlights(name: str, whiter: float) -> list[str]:
        if whiter < _SOME:
            return []
        return [
            f"{name}: {whiter:.1%} of the texels are brighter and whiter than skin. If these are "
            "highlights or light that is baked in, they stay in the offset, and in an edit; paint "
            "them out for an even result."
        ]

    @staticmethod
    def _describe_bound(name: str, bound: float, skin: float) -> list[str]:
        if bound <= _MUCH * skin:
            return []
        return [
            f"{name}: {bound / skin:.0%} of the skin has the least or the most hemoglobin that is "
            f"looked for (0 or {F_BLOOD_RANGE[1]:g}): its colours are yellower or redder than skin "
            "under this light and camera, and a factor cannot change 0. Name the light and the "
            "camera, or fit them: --calibration exposure, or full."
        ]
