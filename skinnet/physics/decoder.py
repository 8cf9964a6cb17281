"""The differentiable skin layer: pigment maps, shading and capture to linear sRGB."""

import torch
from jaxtyping import Float
from torch import Tensor, nn

from skinnet.errors import InputError
from skinnet.physics._parameters import check_fraction
from skinnet.physics.camera import SpectralCamera, apply_matrix
from skinnet.physics.capture import Capture
from skinnet.physics.lookup import SkinLookup
from skinnet.physics.optics import SkinOptics
from skinnet.physics.reflectance import SkinReflectance


class SkinDecoder(nn.Module):
    """Photograph of skin: image = shading * skin(f_mel, f_blood) + specular * white + offset.

    The dichromatic image of model and residual (Alotaibi & Smith 2017, equations 4 and 11). `fast`
    interpolates a colour table made for each image's light and camera; without it the closed form
    is evaluated at 33 bands for every pixel. The two agree within 5e-4 in linear RGB.

    `optics` is a `SkinOptics` or a preset's name, `camera` a `SpectralCamera`; constants that are
    parameters there are trained here.
    """

    def __init__(
        self,
        optics: SkinOptics | str = "calibrated",
        camera: SpectralCamera | None = None,
        fast: bool = True,
        dtype: torch.dtype | None = None,
    ):
        super().__init__()
        self.lookup = SkinLookup(SkinReflectance(optics, dtype=dtype))
        self.camera = camera or SpectralCamera(dtype=dtype)
        self.fast = fast

    @property
    def reflectance(self) -> SkinReflectance:
        """The closed form, with its constants."""
        return self.lookup.reflectance

    def forward(
        self,
        f_mel: Float[Tensor, "*#batch height width"],
        f_blood: Float[Tensor, "*#batch height width"],
        shading: Float[Tensor, "*#batch height width"] | None = None,
        specular: Float[Tensor, "*#batch height width"] | None = None,
        offset: Float[Tensor, "*#batch 3 height width"] | None = None,
        capture: Capture | None = None,
    ) -> Float[Tensor, "*shape 3 height width"]:
        """Linear sRGB, not clipped, of volume fractions in [0, 1].

        `shading` (None: 1) and `specular` (None: 0) are relative to the light, `offset` (None: 0)
        is in linear sRGB. Without a capture: D65, the mean camera, a perfect white balance.
        Leading axes of maps and capture are broadcast. Raises `ValueError` for a fraction that is
        not a number, negative, or above one.
        """
        f_mel = check_fraction("f_mel", f_mel, like=self.camera.mean)
        f_blood = check_fraction("f_blood", f_blood, like=self.camera.mean)
        if f_mel.ndim < 2 or f_mel.shape[-2:] != f_blood.shape[-2:]:
            raise InputError(
                f"f_mel and f_blood are maps [..., height, width] of one size; got shapes "
                f"{tuple(f_mel.shape)} and {tuple(f_blood.shape)}. SkinReflectance takes any shape."
            )
        capture = capture or self.camera.standard()
        batch = torch.broadcast_shapes(
            f_mel.shape[:-2], f_blood.shape[:-2], capture.temperature.shape
        )
        size = f_mel.shape[-2:]
        dtype = torch.promote_types(f_mel.dtype, self.camera.mean.dtype)
        f_mel, f_blood = (f.to(dtype).expand((*batch, *size)) for f in (f_mel, f_blood))
        capture = capture.expand(batch, self.camera.mean.dtype)
        return self.compose(f_mel, f_blood, shading, specular, offset, capture)

    def compose(
        self,
        f_mel: Float[Tensor, "*batch height width"],
        f_blood: Float[Tensor, "*batch height width"],
        shading: Float[Tensor, "*batch height width"] | None,
        specular: Float[Tensor, "*batch height width"] | None,
        offset: Float[Tensor, "*batch 3 height width"] | None,
        capture: Capture,
    ) -> Float[Tensor, "*batch 3 height width"]:
        """`forward` without its checks, for graphs that are trained or exported."""
        matrix = self.camera.matrix(capture).to(f_mel)
        image = self.skin(f_mel, f_blood, matrix)
        if shading is not None:
            image = image * shading[..., None, :, :]
        if specular is not None:
            image = image + specular[..., None, :, :] * matrix.sum(-2)[..., None, None]
        return image if offset is None else image + offset

    def skin(
        self,
        f_mel: Float[Tensor, "*batch height width"],
        f_blood: Float[Tensor, "*batch height width"],
        matrix: Float[Tensor, "*batch wavelength 3"],
    ) -> Float[Tensor, "*batch 3 height width"]:
        """Colour of the skin itself, the albedo, for each image's spectrum-to-RGB matrix."""
        if not self.fast:
            return apply_matrix(self.reflectance.bands(f_mel, f_blood), matrix).movedim(-1, -3)
        batch, size = f_mel.shape[:-2], f_mel.shape[-2:]
        image = self.lookup.sample(
            self.lookup.colours(matrix).reshape(-1, 3, *self.lookup.nodes),
            f_mel.reshape(-1, *size),
            f_blood.reshape(-1, *size),
        )
        return image.reshape(*batch, 3, *size)
