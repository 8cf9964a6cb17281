"""Spectral image formation: light, camera and white balance, from spectra to linear sRGB."""

from functools import cache

import torch
from jaxtyping import Float
from torch import Tensor, nn

from skinnet.physics._linear_algebra import apply_matrix, invert_3x3
from skinnet.physics._parameters import register_constant
from skinnet.physics._tables import read_table
from skinnet.physics.capture import Capture
from skinnet.physics.illuminants import daylight
from skinnet.physics.spectra import load_cameras, load_observer
from skinnet.physics.srgb import srgb_to_xyz

LIGHTS = ("D", *read_table("illuminants"))
"""Names of the lights in a mixture: daylight of the given temperature, then CIE illuminants."""

CAMERA_COMPONENTS = 6
"""Principal components of the camera basis; they explain 92 % of the variance of 52 cameras."""


class SpectralCamera(nn.Module):
    """A camera with white balance: spectra [..., 33] to linear sRGB [..., 3].

    raw_C = sum_j e_j S_jC r_j (equation 4), balanced = raw / white, XYZ = M(S) balanced, and XYZ to
    linear sRGB. Lights are convex mixtures of `LIGHTS`, of unit sum. Sensitivities are the mean
    plus principal components of 52 measured cameras, each channel of unit sum.

    Constants are buffers; one that is handed in as an `nn.Parameter` is trained.

    Args:
        components: Number of principal components of the measured cameras, at most 51.
        mean: Mean sensitivity [33, 3]; None: that of the measured cameras.
        basis: Components [components, 33, 3], one standard deviation each; None: those of the
            measured cameras.
        lights: Relative power [8, 33] of the lights in `LIGHTS` that are not daylight.
        dtype: Precision of the constants; None: torch's default.

    Attributes:
        explained: Share of the cameras' variance that each component explains.

    Source:
        Equation 1 of Alotaibi & Smith 2017 (section 3.1) in its discrete form, equation 4 (section
        3.5). White balance and colour matrix are beyond the paper: a photograph has been through
        both.

    Example:
        >>> import torch
        >>> from skinnet.physics import SpectralCamera
        >>> camera = SpectralCamera()
        >>> white, grey = camera(torch.stack([torch.ones(33), torch.full((33,), 0.2)]))
        >>> [round(value, 4) for value in white.tolist() + grey.tolist()]
        [1.0, 1.0, 1.0, 0.2, 0.2, 0.2]
    """

    mean: Tensor
    basis: Tensor
    lights: Tensor
    explained: Tensor
    observer: Tensor
    daylight: Tensor

    def __init__(
        self,
        components: int = CAMERA_COMPONENTS,
        mean: Float[Tensor, "wavelength 3"] | None = None,
        basis: Float[Tensor, "components wavelength 3"] | None = None,
        lights: Float[Tensor, "lamps wavelength"] | None = None,
        dtype: torch.dtype | None = None,
    ) -> None:
        super().__init__()
        dtype = dtype or torch.get_default_dtype()
        measured_mean, measured_basis, explained = _camera_basis()
        constants = {
            "mean": measured_mean if mean is None else mean,
            "basis": measured_basis[:components] if basis is None else basis,
            "lights": _to_unit_sum(torch.stack(list(read_table("illuminants").values())))
            if lights is None
            else lights,
        }
        for name, value in constants.items():
            register_constant(self, name, value, dtype)
        tables = {
            "explained": explained[:components],
            "observer": load_observer(),
            "daylight": torch.stack(list(read_table("daylight").values())),
        }
        for name, value in tables.items():
            register_constant(self, name, value, dtype, persistent=False)

    def forward(
        self, reflectance: Float[Tensor, "*shape wavelength"], capture: Capture | None = None
    ) -> Float[Tensor, "*shape 3"]:
        """Render reflectance spectra as linear sRGB (equation 4).

        Args:
            reflectance: Spectra whose leading axes are those of `capture`, then any others.
            capture: Light and camera; None: D65, the mean camera, a perfect white balance.

        Returns:
            Linear sRGB, not clipped; white is (1, 1, 1).
        """
        return apply_matrix(reflectance, self.matrix(capture or self.standard()))

    def standard(self, shape: tuple[int, ...] = ()) -> Capture:
        """Return D65, the mean camera and a perfect white balance.

        Args:
            shape: Leading axes of the capture.

        Returns:
            The capture.
        """
        return Capture.standard(len(self.lights) + 1, len(self.basis), shape, self.mean)

    def matrix(self, capture: Capture) -> Float[Tensor, "*batch wavelength 3"]:
        """Compute the spectrum-to-sRGB matrix of each capture.

        Args:
            capture: Light and camera of each photograph.

        Returns:
            The matrices; a spectrum times a matrix is linear sRGB.
        """
        sensitivity = self.sensitivity(capture.camera)
        power = self.mix_lights(capture.light, capture.temperature)
        red, blue = capture.white_balance.unbind(-1)
        gain = torch.stack([red, torch.zeros_like(red), blue], -1).exp()
        return spectrum_to_srgb(power, sensitivity, self.observer, gain)

    def mix_lights(
        self, weights: Float[Tensor, "*batch lights"], temperature: Float[Tensor, "*batch"]
    ) -> Float[Tensor, "*batch wavelength"]:
        """Compute the relative power of mixtures of lights.

        Args:
            weights: Convex weights of `LIGHTS`.
            temperature: Correlated colour temperature of the daylight, 4,000 to 25,000 K.

        Returns:
            Power of unit sum.
        """
        day = daylight(temperature, self.daylight)
        return _to_unit_sum(weights[..., :1] * day + weights[..., 1:] @ self.lights)

    def sensitivity(
        self, coefficients: Float[Tensor, "*batch components"]
    ) -> Float[Tensor, "*batch wavelength 3"]:
        """Compute the spectral sensitivity of cameras, each channel of unit sum.

        Args:
            coefficients: Coefficients of the components, in standard deviations.

        Returns:
            Sensitivities of R, G and B.
        """
        return self.mean + torch.einsum("...c,cwk->...wk", coefficients, self.basis)

    def white(self, capture: Capture) -> Float[Tensor, "*batch 3"]:
        """Compute the linear sRGB of a perfect diffuser.

        Args:
            capture: Light and camera of each photograph.

        Returns:
            (1, 1, 1), except for the error of the white balance.
        """
        return self.matrix(capture).sum(-2)


def spectrum_to_srgb(
    light: Float[Tensor, "*#batch wavelength"],
    sensitivity: Float[Tensor, "*#batch wavelength 3"],
    observer: Float[Tensor, "wavelength 3"],
    gain: Float[Tensor, "*#batch 3"] | None = None,
) -> Float[Tensor, "*batch wavelength 3"]:
    """Compute the matrix from a reflectance spectrum to white-balanced linear sRGB.

    Raw values are balanced by the raw value of white. M, from balanced values to XYZ, is the
    least-squares map from the balanced sensitivities to the observer, with its rows scaled so that
    white goes to D65. (Rows that sum to one, as a follow-up paper prints, send white to (1.205,
    .948, .909).) The rows of the map from balanced values to linear sRGB then sum to one. Dividing
    by that sum changes nothing in exact arithmetic, and keeps neutrals neutral in float32.

    Args:
        light: Relative power of the light, of any scale.
        sensitivity: Sensitivity of the camera, each channel of any scale.
        observer: CIE 1931 colour matching functions, from `load_observer`.
        gain: Factors of the balanced channels, the error of the white balance; None: 1.

    Returns:
        The matrix; a spectrum times it is linear sRGB.

    Source:
        Equation 4 of Alotaibi & Smith 2017; XYZ to sRGB by IEC 61966-2-1.

    Example:
        >>> from skinnet.physics import load_camera, load_light, load_observer, spectrum_to_srgb
        >>> light, camera = load_light("A"), load_camera("Nikon D200")
        >>> white = spectrum_to_srgb(light, camera, load_observer()).sum(0)
        >>> [round(value, 6) for value in white.tolist()]
        [1.0, 1.0, 1.0]
    """
    balanced, to_srgb = _balance(light, sensitivity, observer)
    if gain is not None:
        balanced = balanced * gain[..., None, :]
    return balanced @ to_srgb


def _balance(
    light: Float[Tensor, "*#batch wavelength"],
    sensitivity: Float[Tensor, "*#batch wavelength 3"],
    observer: Float[Tensor, "wavelength 3"],
) -> tuple[Float[Tensor, "*batch wavelength 3"], Float[Tensor, "*batch 3 3"]]:
    """Compute the matrices from a spectrum to balanced values, and from these to linear sRGB."""
    white = (light[..., None] * sensitivity).sum(-2, keepdim=True)
    sensitivity = sensitivity / white
    to_xyz = invert_3x3(sensitivity.mT @ sensitivity) @ (sensitivity.mT @ observer)  # M transposed
    srgb = srgb_to_xyz().to(to_xyz)
    to_xyz = to_xyz * (srgb.sum(-1) / to_xyz.sum(-2, keepdim=True))
    to_srgb = to_xyz @ invert_3x3(srgb).mT
    return light[..., None] * sensitivity, to_srgb / to_srgb.sum(-2, keepdim=True)


@cache
def _camera_basis() -> tuple[Tensor, Tensor, Tensor]:
    """Mean [33, 3], components [51, 33, 3] and explained variance [51] of the measured cameras.

    A joint principal component analysis of the three channels, each of unit sum; a component is
    scaled to one standard deviation over the 52 cameras.
    """
    curves = torch.stack(list(load_cameras().values()))
    mean = curves.mean(0)
    _, values, vectors = torch.linalg.svd((curves - mean).flatten(1), full_matrices=False)
    kept = len(curves) - 1
    deviations = values[:kept] / kept**0.5
    basis = deviations[:, None, None] * vectors[:kept].unflatten(1, mean.shape)
    return mean, basis, values[:kept] ** 2 / (values**2).sum()


def _to_unit_sum(spectra: Float[Tensor, "*batch wavelength"]) -> Float[Tensor, "*batch wavelength"]:
    return spectra / spectra.sum(-1, keepdim=True)
