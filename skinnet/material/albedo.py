"""The colours of an albedo texture as pigments, and back."""

from typing import NamedTuple

import numpy as np
import torch
from jaxtyping import Float, Float32

from skinnet.appearance._offset_factor import compute_offset_factor
from skinnet.appearance.colour import SkinColour
from skinnet.appearance.edit import PigmentEdit
from skinnet.errors import InputError
from skinnet.material._pigment_maps import PigmentMaps
from skinnet.physics.sources import load_spectrum_to_srgb


class AlbedoMaps(NamedTuple):
    """Pigments of an albedo, and what they leave unexplained.

    Attributes:
        f_mel: Volume fraction of melanosomes, of the nearest colour of skin; 0 to .43.
        f_blood: Volume fraction of blood, likewise; 0 to .15.
        f_mel_sd: Standard deviation of f_mel over the skins of people that have the colour (the
            posterior of `SkinInverse.posterior`); 0 where the colour is no skin's.
        f_blood_sd: The same of f_blood.
        skin: How far a colour is one that skin has, in [0, 1]; edits are weighed by it.
        offset: Linear RGB less that of the skin model.
    """

    f_mel: Float32[np.ndarray, "*texels"]
    f_blood: Float32[np.ndarray, "*texels"]
    f_mel_sd: Float32[np.ndarray, "*texels"]
    f_blood_sd: Float32[np.ndarray, "*texels"]
    skin: Float32[np.ndarray, "*texels"]
    offset: Float32[np.ndarray, "*texels 3"]

    def flatten(self) -> "AlbedoMaps":
        """Put all texels into one axis.

        Returns:
            The same maps.
        """
        f_mel, f_blood, f_mel_sd, f_blood_sd, skin = (one.ravel() for one in self[:5])
        return AlbedoMaps(f_mel, f_blood, f_mel_sd, f_blood_sd, skin, self.offset.reshape(-1, 3))


class AlbedoColour:
    """The colour of skin in albedo textures under one light and camera, and its inverse.

    Args:
        light: Light by name or .csv, as of `load_light`.
        camera: Camera by name or .csv, as of `load_camera`; `observer` for textures whose sRGB is
            the colour that people see.
        transform: Colour transform that multiplies the model's RGB from the left (section 4.3);
            None: the identity.

    Raises:
        InputError: For a light, a camera or a transform that cannot be used.

    Source:
        Sections 4.3, 4.4 and 6 of Alotaibi & Smith 2017.

    Example:
        >>> import numpy as np
        >>> colour = AlbedoColour()
        >>> albedo = np.array([[[0.50, 0.27, 0.18], [0.0, 0.6, 0.0]]], np.float32)  # skin, paint
        >>> maps = colour.invert(albedo)
        >>> maps.skin.tolist()
        [[1.0, 0.0]]
        >>> tanned = colour.edit(albedo, melanin=PigmentEdit(scale=1.5))
        >>> bool((tanned[0, 0] < albedo[0, 0]).all()), bool((tanned[0, 1] == albedo[0, 1]).all())
        (True, True)
    """

    def __init__(
        self,
        light: str = "D65",
        camera: str = "observer",
        transform: Float[np.ndarray, "3 3"] | None = None,
    ) -> None:
        matrix = load_spectrum_to_srgb(light, camera).numpy()
        if transform is not None and (
            np.shape(transform) != (3, 3) or not np.linalg.cond(transform) < 1e4
        ):
            raise InputError(f"A transform is 3 x 3 and has an inverse; got {transform}.")
        self.colour = SkinColour(matrix, transform, light=str(light), camera=str(camera))
        self._maps = PigmentMaps(self.colour)

    def decode(
        self, f_mel: Float32[np.ndarray, "*texels"], f_blood: Float32[np.ndarray, "*texels"]
    ) -> Float32[np.ndarray, "*texels 3"]:
        """Compute the linear RGB of skin.

        Args:
            f_mel: Volume fraction of melanosomes; clamped to [0, 1].
            f_blood: Volume fraction of blood; clamped to [0, 1].

        Returns:
            Linear RGB without offset.
        """
        flat = (torch.from_numpy(np.ascontiguousarray(f).ravel()) for f in (f_mel, f_blood))
        with torch.no_grad():
            rgb = self.colour.skin(*flat).T.contiguous().numpy()
        return np.asarray(rgb.reshape(*f_mel.shape, 3))

    def invert(self, albedo: Float32[np.ndarray, "*texels 3"]) -> AlbedoMaps:
        """Invert linear RGB to pigments and an offset.

        Args:
            albedo: Linear RGB of any size and sign.

        Returns:
            The maps.
        """
        linear = np.asarray(albedo, np.float32)
        flat = np.ascontiguousarray(linear).reshape(-1, 3)
        f_mel, f_blood, f_mel_sd, f_blood_sd, skin = (
            plane.reshape(linear.shape[:-1]) for plane in self._maps(flat)
        )
        offset = linear - self.decode(f_mel, f_blood)
        return AlbedoMaps(f_mel, f_blood, f_mel_sd, f_blood_sd, skin, offset)

    def edit(
        self,
        albedo: Float32[np.ndarray, "*texels 3"],
        melanin: PigmentEdit | None = None,
        hemoglobin: PigmentEdit | None = None,
        mask: Float[np.ndarray, "*texels"] | None = None,
    ) -> Float32[np.ndarray, "*texels 3"]:
        """Edit the pigments of linear RGB; its offset darkens with the skin and never grows.

        Args:
            albedo: Linear RGB.
            melanin: Edit of f_mel; None: none.
            hemoglobin: Edit of f_blood; None: none.
            mask: Weight of the edit at each texel, in [0, 1]; None: 1 everywhere.

        Returns:
            Linear RGB; what is no skin's colour, and what no edit changes, is exactly the same.

        Raises:
            InputError: The mask has another size.
        """
        maps = self.invert(albedo)
        weight = maps.skin
        if mask is not None:
            if np.shape(mask) != weight.shape:
                raise InputError(
                    f"The mask has the shape {np.shape(mask)} and the albedo {weight.shape}; draw "
                    "it at the albedo's size."
                )
            weight = weight * np.asarray(mask, np.float32)
        nothing = PigmentEdit()
        f_mel = _blend(maps.f_mel, (melanin or nothing)(maps.f_mel), weight)
        f_blood = _blend(maps.f_blood, (hemoglobin or nothing)(maps.f_blood), weight)
        return self._recolour(np.asarray(albedo, np.float32), maps, f_mel, f_blood)

    def _recolour(
        self,
        linear: Float32[np.ndarray, "*texels 3"],
        maps: AlbedoMaps,
        f_mel: Float32[np.ndarray, "*texels"],
        f_blood: Float32[np.ndarray, "*texels"],
    ) -> Float32[np.ndarray, "*texels 3"]:
        """Give texels other fractions; where both are the same, the colour is."""
        before, after = linear - maps.offset, self.decode(f_mel, f_blood)
        offset = (linear - before) * compute_offset_factor(before, after)
        changed = (f_mel != maps.f_mel) | (f_blood != maps.f_blood)
        return np.asarray(np.where(changed[..., None], after + offset, linear))


def _blend(
    before: Float32[np.ndarray, "*texels"],
    after: Float32[np.ndarray, "*texels"],
    weight: Float32[np.ndarray, "*texels"],
) -> Float32[np.ndarray, "*texels"]:
    """Mix two maps; written as a change, so that what is the same keeps its last bit."""
    return np.asarray((before + weight * (after - before)).clip(0, 1), np.float32)
