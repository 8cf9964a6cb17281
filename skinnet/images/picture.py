"""Pictures as their files hold them: pixels, colour space, transparency and metadata."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from skinnet.images._encoding import encode_linear, is_invertible
from skinnet.images._icc import (
    convert_pixels,
    make_linear_profile,
    make_srgb_profile,
    read_signature,
)
from skinnet.images._plain import guess_rgb, to_eight_bits
from skinnet.images.colour_space import ColourSpace
from skinnet.images.srgb import srgb_to_linear

_SRGB = ColourSpace("sRGB", "assumed")


@dataclass(frozen=True, eq=False)
class Picture:
    """A picture as its file holds it, turned upright.

    Attributes:
        name: What messages call it.
        pixels: uint8 or uint16 in `colour_space`: grey [H, W], RGB [H, W, 3] or CMYK [H, W, 4].
        alpha: Opacity of the type of `pixels`, [H, W], not multiplied in; None if all is opaque.
        colour_space: The colour space of the pixels, and how it is known.
        format: Pillow's name of the file's format; "" for an array.
        metadata: What else the file holds, as Pillow names it: `exif`, `xmp`, `dpi` and others.
        notes: Sentences that the user should read, such as what was assumed of the colours.

    Example:
        >>> from skimage.data import astronaut
        >>> from skinnet.images import read_picture
        >>> picture = read_picture(astronaut())
        >>> picture.pixels.shape, picture.colour_space.name, picture.alpha is None
        ((512, 512, 3), 'sRGB', True)
    """

    name: str
    pixels: NDArray[Any]
    alpha: NDArray[Any] | None = None
    colour_space: ColourSpace = _SRGB
    format: str = ""
    metadata: Mapping[str, Any] = field(default_factory=dict)
    notes: tuple[str, ...] = ()

    @cached_property
    def srgb(self) -> NDArray[np.uint8]:
        """uint8 sRGB [H, W, 3], transparent pixels blended with white."""
        rgb = self._to_srgb()
        if self.alpha is None:
            return rgb
        image = Image.fromarray(rgb)
        white = Image.new("RGB", image.size, (255, 255, 255))
        white.paste(image, mask=Image.fromarray(to_eight_bits(self.alpha)))
        return np.array(white)

    def linear(self) -> NDArray[np.float32]:
        """Return linear sRGB at the depth of the pixels.

        Returns:
            float32 [H, W, 3], not blended with white. Colours outside sRGB are outside [0, 1].
        """
        pixels, profile = self._expand()
        if profile is None:
            deep = pixels.dtype == np.uint16
            return srgb_to_linear(pixels.astype(np.float32) / 65535 if deep else pixels)
        converted = convert_pixels(pixels, profile, make_linear_profile(), np.float32)
        return converted.astype(np.float32, copy=False)

    def with_linear(self, linear: NDArray[Any], changed: NDArray[np.bool_]) -> "Picture":
        """Return the picture with some pixels replaced; the others keep their stored values.

        Args:
            linear: Linear sRGB [H, W, 3]; what the colour space cannot hold is clipped.
            changed: Which pixels to replace, [H, W].

        Returns:
            A picture with the same colour space and depth. Grey pixels become RGB, and so do those
            of a profile that gives no way back.
        """
        whole = self.as_colour()
        old = whole.pixels[changed][None]
        wanted = np.asarray(linear, np.float32)[changed][None]
        edited = whole.pixels.copy()
        edited[changed] = encode_linear(wanted, old, whole.colour_space.profile)[0]
        return replace(whole, pixels=edited)

    def as_colour(self) -> "Picture":
        """Return the picture with RGB or CMYK pixels, in a space that can be written.

        Returns:
            The picture itself, where it is so; grey pixels become RGB, and those of a profile that
            gives no way back, such as a scanner's, become sRGB.
        """
        pixels, profile, notes = self.pixels, self.colour_space.profile, self.notes
        if pixels.ndim == 3 and (profile is None or is_invertible(profile)):
            return self
        if pixels.ndim == 2:
            pixels, profile = self._expand()
        if profile is not None and not is_invertible(profile):
            pixels = convert_pixels(pixels, profile, make_srgb_profile(), pixels.dtype)
            name, profile = self.colour_space.name, None
            notes = (*notes, f"{self.name} is converted from {name}, which is only read, to sRGB.")
        space = self.colour_space if profile else ColourSpace("sRGB", "assumed")
        return replace(self, pixels=pixels, colour_space=space, notes=notes)

    def _to_srgb(self) -> NDArray[np.uint8]:
        pixels, profile = self._expand()
        if profile is not None:
            return convert_pixels(pixels, profile, make_srgb_profile(), np.uint8)
        return to_eight_bits(pixels)

    def _expand(self) -> tuple[NDArray[Any], bytes | None]:
        """RGB or CMYK pixels, and their profile; others are converted to sRGB."""
        pixels, profile = self.pixels, self.colour_space.profile
        if pixels.ndim == 2 and profile is not None and read_signature(profile, 16) == "GRAY":
            return convert_pixels(pixels, profile, make_srgb_profile(), pixels.dtype), None
        if pixels.ndim == 2:
            pixels = np.repeat(pixels[..., None], 3, 2)
        if pixels.shape[2] == 4 and profile is None:
            return guess_rgb(pixels), None
        return pixels, profile
