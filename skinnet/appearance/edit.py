"""Changes to the pigments of a skin texture (Alotaibi & Smith 2017, Figure 6)."""

from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float, Float32

from skinnet.appearance.skin_texture import SkinTexture
from skinnet.errors import InputError

LARGEST = 10.0
"""Largest factor."""


@dataclass(frozen=True)
class PigmentEdit:
    """What happens to a map of volume fractions: f -> scale f + add, or to one painted value.

    Args:
        scale: factor from 0 to 10.
        add: volume fraction that is added, in [-1, 1].
        paint: volume fraction in [0, 1] that takes the map's place; null leaves it.
    """

    scale: float = 1.0
    add: float = 0.0
    paint: float | None = None

    def __post_init__(self) -> None:
        if not 0 <= self.scale <= LARGEST:
            raise InputError(
                f"scale is a factor from 0 to {LARGEST:g}; got {self.scale}. Was it given in "
                "percent?"
            )
        if not -1 <= self.add <= 1:
            raise InputError(
                f"add is a volume fraction in [-1, 1]; got {self.add}. Was it given in percent?"
            )
        if self.paint is not None and not 0 <= self.paint <= 1:
            raise InputError(
                f"paint is a volume fraction in [0, 1]; got {self.paint}. Was it given in percent?"
            )

    def __call__(self, fraction: Float32[np.ndarray, "*map"]) -> Float32[np.ndarray, "*map"]:
        """The changed map, kept in [0, 1]."""
        if self.paint is not None:
            return np.full_like(fraction, self.paint)
        return np.asarray((self.scale * fraction + self.add).clip(0, 1), np.float32)


def edit_texture(
    texture: SkinTexture,
    melanin: PigmentEdit,
    hemoglobin: PigmentEdit,
    mask: Float[np.ndarray, "size size"] | None = None,
) -> SkinTexture:
    """A texture with changed pigments; what is not skin, its offset, stays.

    `mask` in [0, 1] says how much of the change each texel takes. Raises `InputError` for a mask of
    another size.
    """
    weight = np.ones_like(texture.f_mel) if mask is None else mask.astype(np.float32)
    if weight.shape != texture.f_mel.shape:
        raise InputError(
            f"The mask is {weight.shape[1]} x {weight.shape[0]} and the maps of {texture.name} are "
            f"{len(texture.mask)} x {len(texture.mask)}; draw it at their size."
        )
    maps = {
        name: (1 - weight) * before + weight * edit(before)
        for name, before, edit in (
            ("f_mel", texture.f_mel, melanin),
            ("f_blood", texture.f_blood, hemoglobin),
        )
    }
    return replace(texture, **maps)
