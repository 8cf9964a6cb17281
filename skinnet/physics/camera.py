"""Light, camera and colour pipeline: from spectra to linear sRGB."""

from functools import cache

import torch
from jaxtyping import Float
from torch import Tensor, nn

from skinnet.physics._linear_algebra import invert_3x3
from skinnet.physics._parameters import register_constant
from skinnet.physics._tables import read_table
from skinnet.physics.capture import Capture
from skinnet.physics.illuminants import daylight
from skinnet.physics.spectra import load_cameras, load_observer
from skinnet.physics.srgb import srgb_to_xyz

LIGHTS = ("D", *read_table("illuminants"))
"""Names of the lights in a mixture: daylight of the given temperature, then CIE illuminants."""

CAMERA_COMPONENTS = 6
"""Components of the camera basis; they explain 92 % of the variance of 52 cameras."""


class SpectralCamera(nn.Module):
    """A camera that balances its white: spectra [..., 33] to linear sRGB [..., 3].

    raw_C = sum_j e_j S_jC r_j (equation 4), wb = raw / white, XYZ = M(S) wb, linear = XYZ -> sRGB.

    Lights are convex mixtures of `LIGHTS`, of unit sum. Sensitivities are the mean plus principal
    components of 52 measured cameras of unit sum; `explained` [components] is the share of variance
    of each. `mean` [33, 3], `basis` [components, 33, 3] (one standard deviation each) and `lights`
    [8, 33] may be replaced, and are trainable if an `nn.Parameter` is handed in.
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
    ):
        super().__init__()
        dtype = dtype or torch.get_default_dtype()
        measured_mean, measured_basis, explained = _camera_basis()
        constants = {
            "mean": measured_mean if mean is None else mean,
            "basis": measured_basis[:components] if basis is None else basis,
            "lights": _unit_sum(torch.stack(list(read_table("illuminants").values())))
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
        """Linear sRGB of spectra whose leading axes are those of `capture`, then any others.

        Without a capture: D65, the mean camera, a perfect white balance.
        """
        return apply_matrix(reflectance, self.matrix(capture or self.standard()))

    def standard(self, shape: tuple[int, ...] = ()) -> Capture:
        """D65, the mean camera and a perfect white balance, for photographs of that shape."""
        return Capture.standard(len(self.lights) + 1, len(self.basis), shape, self.mean)

    def matrix(self, capture: Capture) -> Float[Tensor, "*batch wavelength 3"]:
        """The map from a spectrum to linear sRGB, which is linear for a given light and camera."""
        sensitivity = self.sensitivity(capture.camera)
        power = self.mix_lights(capture.light, capture.temperature)
        red, blue = capture.white_balance.unbind(-1)
        gain = torch.stack([red, torch.zeros_like(red), blue], -1).exp()
        return spectrum_to_srgb(power, sensitivity, self.observer, gain)

    def mix_lights(
        self, weights: Float[Tensor, "*batch lights"], temperature: Float[Tensor, "*batch"]
    ) -> Float[Tensor, "*batch wavelength"]:
        """Relative power of a mixture, of unit sum."""
        day = daylight(temperature, self.daylight)
        return _unit_sum(weights[..., :1] * day + weights[..., 1:] @ self.lights)

    def sensitivity(
        self, coefficients: Float[Tensor, "*batch components"]
    ) -> Float[Tensor, "*batch wavelength 3"]:
        """Spectral sensitivity of the camera with these coefficients, each channel of unit sum."""
        return self.mean + torch.einsum("...c,cwk->...wk", coefficients, self.basis)

    def white(self, capture: Capture) -> Float[Tensor, "*batch 3"]:
        """Linear sRGB of a perfect diffuser: (1, 1, 1) but for the error of the white balance."""
        return self.matrix(capture).sum(-2)


def spectrum_to_srgb(
    light: Float[Tensor, "*#batch wavelength"],
    sensitivity: Float[Tensor, "*#batch wavelength 3"],
    observer: Float[Tensor, "wavelength 3"],
    gain: Float[Tensor, "*#batch 3"] | None = None,
) -> Float[Tensor, "*batch wavelength 3"]:
    """Matrix from a reflectance spectrum to linear sRGB under any light and camera.

    `gain` multiplies the balanced channels; None is a perfect white balance. M is the least-squares
    map from the sensitivities, each divided by its raw white as the channels it is applied to are,
    to the observer with its rows scaled so that white goes to D65 (rows
    that sum to one, as a follow-up paper prints, send it to (1.205, .948, .909)). The rows of the
    whole map from balanced channels to linear sRGB then sum to one; dividing by that sum changes
    nothing in exact arithmetic and keeps neutrals neutral in float32.
    """
    white = (light[..., None] * sensitivity).sum(-2, keepdim=True)
    sensitivity = sensitivity / white
    to_xyz = invert_3x3(sensitivity.mT @ sensitivity) @ (sensitivity.mT @ observer)  # M transposed
    balanced = light[..., None] * sensitivity
    if gain is not None:
        balanced = balanced * gain[..., None, :]
    srgb = srgb_to_xyz().to(to_xyz)
    to_xyz = to_xyz * (srgb.sum(-1) / to_xyz.sum(-2, keepdim=True))
    to_srgb = to_xyz @ invert_3x3(srgb).mT
    return balanced @ (to_srgb / to_srgb.sum(-2, keepdim=True))


def apply_matrix(
    spectra: Float[Tensor, "*shape wavelength"], matrix: Float[Tensor, "*batch wavelength 3"]
) -> Float[Tensor, "*shape 3"]:
    """Spectra [*batch, ..., 33] times one matrix for each element of the batch."""
    batch = matrix.ndim - 2
    flat = spectra.flatten(batch, -2) if spectra.ndim - 1 > batch else spectra[..., None, :]
    product = flat @ matrix
    return product.reshape(*product.shape[:-2], *spectra.shape[batch:-1], 3)


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


def _unit_sum(spectra: Float[Tensor, "*batch wavelength"]) -> Float[Tensor, "*batch wavelength"]:
    return spectra / spectra.sum(-1, keepdim=True)
