"""Edits of the pigments of a skin texture (section 6 of Alotaibi & Smith 2017)."""

from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float, Float32

from skinnet.appearance._offset_factor import compute_offset_factor
from skinnet.appearance.colour import SkinColour
from skinnet.appearance.skin_texture import SkinTexture
from skinnet.errors import InputError

_LARGEST_SCALE = 10.0


@dataclass(frozen=True)
class PigmentEdit:
    """An edit of a map of volume fractions: f -> scale f + add, or one painted value.

    Args:
        scale: Factor from 0 to 10.
        add: Volume fraction that is added, in [-1, 1].
        paint: Volume fraction in [0, 1] that replaces the map; None: the map is not replaced.

    Raises:
        InputError: If a value lies outside its range.

    Source:
        Section 6 and Figure 6 of Alotaibi & Smith 2017.

    Example:
        >>> tan = PigmentEdit(scale=1.5)
        >>> [round(float(f), 3) for f in tan(np.array([0.02, 0.9], np.float32))]
        [0.03, 1.0]
    """

    scale: float = 1.0
    add: float = 0.0
    paint: float | None = None

    def __post_init__(self) -> None:
        if not 0 <= self.scale <= _LARGEST_SCALE:
            raise InputError(
                f"scale is a factor from 0 to {_LARGEST_SCALE:g}; got {self.scale}. Was it given "
                "in percent?"
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
        """Apply the edit to a map and clip the result to [0, 1].

        Args:
            fraction: Map of volume fractions.

        Returns:
            The edited map.
        """
        if self.paint is not None:
            return np.full_like(fraction, self.paint)
        return np.asarray((self.scale * fraction + self.add).clip(0, 1), np.float32)


def edit_texture(
    texture: SkinTexture,
    colour: SkinColour,
    melanin: PigmentEdit,
    hemoglobin: PigmentEdit,
    mask: Float[np.ndarray, "size size"] | None = None,
) -> SkinTexture:
    """Edit the pigments of a texture; its offset darkens with the skin and never grows.

    The offset is a difference of colours that was found at one lightness. Added to skin that an
    edit makes darker, it would outweigh the skin and tint it, so each channel is multiplied by the
    ratio of the model's colours after and before. In a channel that becomes lighter it stays:
    multiplied as well, an error in the little blue of dark skin would be seen several times larger.

    Args:
        texture: Maps to edit; they are not changed in place.
        colour: Light, camera and calibration of the maps.
        melanin: Edit of f_mel.
        hemoglobin: Edit of f_blood.
        mask: Weight of the edit at each texel, in [0, 1]; None: 1 everywhere.

    Returns:
        The edited texture; texels whose fractions stay the same are exactly the same.

    Raises:
        InputError: If the mask has another size than the maps.

    Source:
        Section 6 and Figure 6 of Alotaibi & Smith 2017, where the offset stays the same.

    Example:
        >>> level, known = np.full((2, 2), 0.04, np.float32), np.ones((2, 2), bool)
        >>> face = SkinTexture(level, level, np.full((2, 2, 3), 0.01, np.float32), known)
        >>> colour = SkinColour(nodes=(32, 32))
        >>> tanned = edit_texture(face, colour, PigmentEdit(scale=4.0), PigmentEdit())
        >>> round(float(tanned.f_mel[0, 0]), 3), bool((tanned.offset < face.offset).all())
        (0.16, True)
    """
    weight = np.ones_like(texture.f_mel) if mask is None else mask.astype(np.float32)
    if weight.shape != texture.f_mel.shape:
        raise InputError(
            f"The mask is {weight.shape[1]} x {weight.shape[0]} and the maps of {texture.name} are "
            f"{len(texture.mask)} x {len(texture.mask)}; draw it at their size."
        )
    # Written as a change, so that a texel whose fraction stays the same keeps its last bit.
    edited = replace(
        texture,
        f_mel=texture.f_mel + weight * (melanin(texture.f_mel) - texture.f_mel),
        f_blood=texture.f_blood + weight * (hemoglobin(texture.f_blood) - texture.f_blood),
    )
    before, after = (_decode_bare(one, colour) for one in (texture, edited))
    return replace(edited, offset=texture.offset * compute_offset_factor(before, after))


def _decode_bare(texture: SkinTexture, colour: SkinColour) -> Float32[np.ndarray, "size size 3"]:
    """Compute the linear RGB of the skin without its offset."""
    return replace(texture, offset=np.zeros_like(texture.offset)).albedo(colour)
