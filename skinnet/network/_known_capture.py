"""What is known of a capture, as an input of the network: each part may be missing."""

import torch
from jaxtyping import Float
from torch import Tensor, nn

from skinnet.physics._linear_algebra import invert_3x3
from skinnet.physics.camera import CAMERA_COMPONENTS, LIGHTS, SpectralCamera, spectrum_to_srgb
from skinnet.physics.capture import Capture

KNOWN_VALUES = len(LIGHTS) + 1 + CAMERA_COMPONENTS + 2 + 1 + 6
"""Values of light, temperature, camera, white balance and exposure, and a flag for each and for
linear."""

_MIRED, _MIRED_SPREAD = 160.0, 40.0
"""Daylight of 6,250 K, and the spread over usual daylight, in mired."""

_SIZES = (len(LIGHTS), None, CAMERA_COMPONENTS, 2, None, None)
"""Values of each part of a capture; None: a number."""

_WHITE = 0.8
"""Reflectance of the grey spectra among those of skin, which keep neutrals neutral."""

_MOST_TOLD = 0.1
"""Largest white balance that is described. All of it is divided out of the photograph; the network
would take more of it for a sign of other skin."""

_RIDGE = 1e-3
"""Weight of no change, for each spectrum."""

_Image = Float[Tensor, "batch 3 height width"]


class KnownCapture(nn.Module):
    """Turns what is known of captures into values of a network.

    Missing parts are NaN, and their flag is 0. A known white balance is divided out of the
    photograph in the channels of the mean camera, and skin's colours under a known light and camera
    are turned into those under D65 and the mean camera; what remains is estimated.

    Args:
        camera: Statistical model of cameras.
        spectra: Reflectance of skin, whose colours are turned; None: light and camera are ignored.
    """

    to_srgb: Tensor
    to_camera: Tensor
    spectra: Tensor | None

    def __init__(
        self, camera: SpectralCamera, spectra: Float[Tensor, "skins wavelength"] | None = None
    ) -> None:
        super().__init__()
        # The map from a camera's balanced channels to sRGB is that of the channels' gains.
        gains = torch.eye(3).to(camera.mean)
        matrix = torch.stack([_white(camera, gain) for gain in gains], -1)
        self.register_buffer("to_srgb", matrix, persistent=False)
        self.register_buffer("to_camera", invert_3x3(matrix), persistent=False)
        if spectra is not None:
            white = spectra.new_full((len(spectra) // 4, spectra.shape[-1]), _WHITE)
            spectra = torch.cat([spectra, white]).to(camera.mean)
        self.register_buffer("spectra", spectra, persistent=False)

    def complete(self, known: Capture | None, count: int, like: Tensor) -> Capture:
        """Give every part one row for each photograph, NaN where it is not known."""
        parts = known or Capture()
        rows = []
        for part, size in zip(parts, _SIZES, strict=True):
            shape = (count,) if size is None else (count, size)
            rows.append(like.new_full(shape, torch.nan) if part is None else part.expand(shape))
        return Capture(*rows)

    def normalise(self, linear: _Image, known: Capture, camera: SpectralCamera) -> _Image:
        """Make photographs in linear sRGB as if what is known of the capture were the standard."""
        # Autocast would compute the matrices with eight bits of precision, and invert them.
        device = linear.device.type
        if torch.is_autocast_enabled(device):
            with torch.autocast(device, enabled=False):
                return self.normalise(linear, known, camera)
        balanced = self._balance(linear, known)
        if self.spectra is None:
            return balanced
        matrix = self._turn_to_standard(known, camera)
        turned = (matrix.mT[..., None, None] * balanced[:, None]).sum(2).clamp_min(0)
        unknown = (known.light.isnan().any(-1) & known.camera.isnan().any(-1))[:, None, None, None]
        return torch.where(unknown, balanced, turned)

    def _turn_to_standard(
        self, known: Capture, camera: SpectralCamera
    ) -> Float[Tensor, "batch 3 3"]:
        """Matrices from skin's colours under the known light and camera to the standard ones.

        Ridge regression towards no change: colours of skin nearly lie in a plane.
        """
        assert self.spectra is not None
        # Not its length, which would be fixed in an exported graph.
        standard = camera.standard((known.temperature.shape[0],))
        missing = [part.isnan() for part in known[:3]]
        missing[1] = missing[1] | missing[0].any(-1)  # it is the temperature of a known light
        light, temperature, sensor = (
            torch.where(no, usual, _fill(own))
            for no, usual, own in zip(missing, standard[:3], known[:3], strict=True)
        )
        # Relative errors, since dark skin should count as light skin does.
        skin = self.spectra / self.spectra.mean(-1, keepdim=True)
        seen = skin @ camera.matrix(Capture(light, temperature, sensor, standard.white_balance))
        wanted = skin @ camera.matrix(standard)
        identity = torch.eye(3).to(seen)
        squares = seen.mT @ seen + _RIDGE * len(self.spectra) * identity
        # As a change from the identity, which loses fewer digits than the whole.
        return identity + invert_3x3(squares) @ (seen.mT @ (wanted - seen))

    def _balance(self, linear: _Image, known: Capture) -> _Image:
        """Divide the known white balance out of photographs in linear sRGB."""
        red, blue = _fill(known.white_balance).unbind(-1)
        gain = torch.stack([red, torch.zeros_like(red), blue], -1)
        correction = self.to_srgb @ ((-gain).exp()[:, :, None] * self.to_camera)
        balanced = (correction[..., None, None] * linear[:, None]).sum(2).clamp_min(0)
        unknown = known.white_balance.isnan().any(-1)[:, None, None, None]
        return torch.where(unknown, linear, balanced)

    def describe(self, known: Capture) -> Float[Tensor, "batch known_values"]:
        """Describe captures by values and flags of about unit size."""
        assert known.linear is not None and known.exposure is not None
        # Filled before they become columns: tools that quantise the network warn of columns of NaN.
        light, temperature, camera, balance = map(_fill, known[:4])
        vectors = (known.light, known.camera, known.white_balance)
        unknown = [part.isnan().any(-1, keepdim=True) for part in vectors]
        unknown.insert(1, known.temperature.isnan()[:, None])
        unknown.append(known.exposure.isnan()[:, None])
        mired = 1e6 / (temperature[:, None] + 1e6 / _MIRED * unknown[1])
        exposure = _fill(known.exposure)[:, None]
        told = balance.clamp(-_MOST_TOLD, _MOST_TOLD)
        parts = (light, (mired - _MIRED) / _MIRED_SPREAD, camera, 5 * told, exposure)
        flags = [(~each).to(balance) for each in unknown]
        values = [part * flag for part, flag in zip(parts, flags, strict=True)]
        return torch.cat([*values, *flags, _fill(known.linear)[:, None]], -1)

    def adopt(self, known: Capture, estimate: Capture) -> Capture:
        """Replace the estimate of light and camera where they are known, and add the balance."""
        light, temperature, camera = (
            torch.where(own.isnan(), guess, _fill(own))
            for own, guess in zip(known[:3], estimate[:3], strict=True)
        )
        balance = _fill(known.white_balance) + estimate.white_balance
        return Capture(light, temperature, camera, balance)

    def find_white_balance(self, white: Float[Tensor, "*batch 3"]) -> Float[Tensor, "*batch 2"]:
        """Find the white balance of a camera that shows white as this linear sRGB."""
        channels = (white[..., None, :] * self.to_camera.to(white)).sum(-1).clamp_min(1e-3)
        red, green, blue = channels.log().unbind(-1)
        return torch.stack([red - green, blue - green], -1)


def _fill(part: Tensor) -> Tensor:
    """Replace what is missing by 0; exported, this is shorter than `nan_to_num`."""
    return part.masked_fill(part.isnan(), 0)


def _white(camera: SpectralCamera, gain: Float[Tensor, "3"]) -> Float[Tensor, "3"]:
    """Linear sRGB of white whose balanced channels have these values."""
    with torch.no_grad():
        standard = camera.standard()
        power = camera.mix_lights(standard.light, standard.temperature)
        sensitivity = camera.sensitivity(standard.camera)
        return spectrum_to_srgb(power, sensitivity, camera.observer, gain).sum(-2)
