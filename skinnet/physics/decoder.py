"""The differentiable skin layer: pigment maps, shading and capture to linear sRGB (equation 4)."""

import torch
from jaxtyping import Float
from torch import Tensor, nn

from skinnet.errors import InputError
from skinnet.physics._linear_algebra import apply_matrix
from skinnet.physics._parameters import check_fraction
from skinnet.physics.camera import SpectralCamera
from skinnet.physics.capture import Capture
from skinnet.physics.lookup import SkinLookup
from skinnet.physics.nuisance import Nuisance
from skinnet.physics.optics import SkinOptics
from skinnet.physics.reflectance import SkinReflectance


class SkinDecoder(nn.Module):
    """Renders skin: image = shading * albedo(f_mel, f_blood) + specular * white + offset.

    The fast mode interpolates a colour table that is computed for each image's light and camera.
    Otherwise the closed form is evaluated at 33 bands for every pixel. The two agree within 5e-4 in
    linear RGB, and except for `printed` in the gradients of each pixel's fractions within 1 %.

    Args:
        optics: Constants of the skin, or the name of a preset. Parameters there are trained here.
        camera: Lights and cameras; None: the measured ones. Parameters there are trained here.
        fast: Whether to interpolate a table.
        dtype: Precision of the constants; None: torch's default.

    Source:
        Equation 4 of Alotaibi & Smith 2017 is the albedo, the offset that of equation 11; the
        dichromatic model adds shading and specular reflection.

    Example:
        >>> import torch
        >>> from skinnet.physics import SkinDecoder
        >>> decoder = SkinDecoder()
        >>> f_mel, f_blood = torch.full((2, 2), 0.03), torch.full((2, 2), 0.05)
        >>> red, green, blue = decoder(f_mel, f_blood)[:, 0, 0].tolist()
        >>> 1 > red > green > blue > 0
        True
    """

    def __init__(
        self,
        optics: SkinOptics | str = "measured",
        camera: SpectralCamera | None = None,
        fast: bool = True,
        dtype: torch.dtype | None = None,
    ) -> None:
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
        """Render maps. Leading axes of maps and capture are broadcast.

        Args:
            f_mel: Melanosome volume fraction, in [0, 1].
            f_blood: Blood volume fraction, in [0, 1].
            shading: Diffuse shading relative to the light; None: 1.
            specular: Specular reflection relative to the light; None: 0.
            offset: Linear sRGB that is added; None: 0.
            capture: Light and camera; None: D65, the mean camera, a perfect white balance.

        Returns:
            Linear sRGB, not clipped.

        Raises:
            InputError: For a fraction that is NaN, negative or above one, and for maps of different
                size or with fewer than two axes.
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
        """Render maps without checks or broadcasting, for graphs that are trained or exported.

        Args:
            f_mel: Melanosome volume fraction.
            f_blood: Blood volume fraction.
            shading: Diffuse shading relative to the light; None: 1.
            specular: Specular reflection relative to the light; None: 0.
            offset: Linear sRGB that is added; None: 0.
            capture: Light and camera of each image.

        Returns:
            Linear sRGB, not clipped.
        """
        matrix = self.camera.matrix(capture).to(f_mel)
        image = self.albedo(f_mel, f_blood, matrix)
        if shading is not None:
            image = image * shading[..., None, :, :]
        if specular is not None:
            image = image + specular[..., None, :, :] * matrix.sum(-2)[..., None, None]
        return image if offset is None else image + offset

    def albedo(
        self,
        f_mel: Float[Tensor, "*batch height width"],
        f_blood: Float[Tensor, "*batch height width"],
        matrix: Float[Tensor, "*batch wavelength 3"],
        nuisance: Nuisance | None = None,
    ) -> Float[Tensor, "*batch 3 height width"]:
        """Render the diffuse albedo: the colour of evenly lit skin (equation 4).

        Nothing is checked here, for graphs that are trained or exported; `forward` checks.

        Args:
            f_mel: Melanosome volume fraction.
            f_blood: Blood volume fraction.
            matrix: Spectrum-to-RGB matrix of each image.
            nuisance: Deviations of each image's skin from the preset [*batch]; None: none.

        Returns:
            Linear sRGB of the albedo.
        """
        if not self.fast:
            if nuisance is not None:
                nuisance = Nuisance(*(deviation[..., None, None] for deviation in nuisance))
            spectra = self.reflectance.bands(f_mel, f_blood, nuisance)
            return apply_matrix(spectra, matrix).movedim(-1, -3)
        batch, size = f_mel.shape[:-2], f_mel.shape[-2:]
        image = self.lookup.sample(
            self.lookup.colours(matrix, nuisance).reshape(-1, 3, *self.lookup.nodes),
            f_mel.reshape(-1, *size),
            f_blood.reshape(-1, *size),
        )
        return image.reshape(*batch, 3, *size)
