"""Encoder, output activations and decoder: a photograph to skin and back."""

import math
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, NamedTuple

import torch
from jaxtyping import Float
from kornia.color import rgb_to_linear_rgb
from torch import Tensor, nn

from skinnet.errors import InputError, _clip
from skinnet.network._earlier_weights import EARLIER_FORMAT, upgrade_config, upgrade_weights
from skinnet.network._known_capture import KNOWN_VALUES, KnownCapture
from skinnet.network._tone_factors import find_factors, measure_tone
from skinnet.network._weights import (
    SHIPPED_WEIGHTS,
    SavedModel,
    read_weights,
    refuse_mismatch,
    write_weights,
)
from skinnet.network.checkpoint import _describe, _make_checkpoint, _read_model
from skinnet.network.encoder import WIDTHS, SkinEncoder
from skinnet.physics.camera import CAMERA_COMPONENTS, LIGHTS
from skinnet.physics.capture import Capture
from skinnet.physics.decoder import SkinDecoder
from skinnet.physics.inversion import F_BLOOD_RANGE, F_MEL_RANGE
from skinnet.physics.srgb import to_display

F_MEL_MAX = F_MEL_RANGE[1]
"""Largest melanosome volume fraction (Table 1 of Alotaibi & Smith 2017)."""

F_BLOOD_MAX = F_BLOOD_RANGE[1]
"""About twice the paper's 7 %: lips and flushed cheeks hold more blood than other skin."""

SHADING_MAX = 4.0
"""Largest diffuse shading, relative to the light."""

CAMERA_MAX = 3.0
"""Largest absolute coefficient of the camera basis, in standard deviations."""

WHITE_BALANCE_MAX = 0.9
"""Largest error of the white balance that is estimated, beyond what is known of it."""

LOG_SD_RANGE = 0.01, 1.5
"""Range of the standard deviation of a pigment's natural logarithm."""

_MIRED = (40.0, 250.0)
"""Range of daylight, 25,000 K to 4,000 K, in mired. Equal steps are about equally visible."""

_SAMPLES = 8
"""Steps of melanin and of blood in the skin by which colours of a known capture are turned."""

_ROUNDING = 1e-3
"""How far outside [0, 1] a photograph may lie, as half precision rounds it."""

_MAP_CHANNELS = 7
_GLOBAL_CHANNELS = len(LIGHTS) + 1 + CAMERA_COMPONENTS + 2 + 2


class SkinMaps(NamedTuple):
    """Maps of skin in a photograph, one value for each pixel.

    Attributes:
        melanin: Melanosome volume fraction, in [0, 0.43].
        hemoglobin: Blood volume fraction, in [0, 0.15].
        shading: Diffuse shading relative to the light, in [0, 4].
        specular: Specular reflection relative to the light, in [0, 1].
        offset: Colour that the skin model does not explain, linear sRGB in [-1, 1]; the encoder's
            is in [0, 1].
        mask: Probability that the pixel is skin, in [0, 1].

    Source:
        Equations 4 and 11 of Alotaibi & Smith 2017; `offset` is delta of equation 11.
    """

    melanin: Float[Tensor, "*batch height width"]
    hemoglobin: Float[Tensor, "*batch height width"]
    shading: Float[Tensor, "*batch height width"]
    specular: Float[Tensor, "*batch height width"]
    offset: Float[Tensor, "*batch 3 height width"]
    mask: Float[Tensor, "*batch height width"]


class Uncertainty(NamedTuple):
    """How uncertain the pigments are: standard deviations of their natural logarithms.

    Attributes:
        melanin: Of each pixel.
        hemoglobin: Of each pixel.
        face: Of the means of melanin and hemoglobin over the skin of a photograph.
    """

    melanin: Float[Tensor, "*batch height width"]
    hemoglobin: Float[Tensor, "*batch height width"]
    face: Float[Tensor, "*batch 2"]


def _activate(
    maps: Float[Tensor, "batch 7 height width"], linear: Float[Tensor, "batch 3 height width"]
) -> SkinMaps:
    """Map raw maps smoothly to physical ranges, in float32 at least.

    Pigments are cubes of a sigmoid. Equal steps of the cube root of a fraction are about equal
    steps of colour, and both ends of the range can be reached. The offset is the photograph,
    `linear` in linear sRGB, times the probability that the pixel is not skin.
    """
    melanin, hemoglobin, shading, specular, mask = maps[:, :5].unbind(1)
    skin = mask.sigmoid()
    # Detached: otherwise a mask without skin would have the smallest reconstruction loss.
    offset = (1 - skin.detach())[:, None] * linear
    return SkinMaps(
        F_MEL_MAX * melanin.sigmoid() ** 3,
        F_BLOOD_MAX * hemoglobin.sigmoid() ** 3,
        SHADING_MAX * (shading - 1.1).sigmoid(),
        (specular - 4).sigmoid(),
        offset,
        skin,
    )


def _activate_capture(
    global_outputs: Float[Tensor, "batch globals"], white_balance_max: float
) -> Capture:
    """Map raw global values to a capture."""
    light, temperature, camera, balance, _ = global_outputs.split(
        [len(LIGHTS), 1, CAMERA_COMPONENTS, 2, 2], -1
    )
    mired = _MIRED[0] + (_MIRED[1] - _MIRED[0]) * temperature.squeeze(-1).sigmoid()
    return Capture(
        light.softmax(-1),
        1e6 / mired,
        CAMERA_MAX * camera.tanh(),
        white_balance_max * balance.tanh(),
    )


def _activate_uncertainty(
    maps: Float[Tensor, "batch 7 height width"],
    global_outputs: Float[Tensor, "batch globals"],
    factors: Float[Tensor, "2 2 batch"],
) -> Uncertainty:
    """Map raw values to standard deviations, times factors for pixels and for faces."""
    low, high = map(math.log, LOG_SD_RANGE)
    pixel, face = (
        (low + (high - low) * raw.sigmoid()).exp() for raw in (maps[:, 5:], global_outputs[:, -2:])
    )
    pixel, face = pixel * factors[0].mT[..., None, None], face * factors[1].mT
    melanin, hemoglobin = pixel.unbind(1)
    return Uncertainty(melanin, hemoglobin, face)


@torch.no_grad()
def _sample_skin(decoder: SkinDecoder) -> Float[Tensor, "skins wavelength"]:
    """Reflectance of skin of all tones, with little and with much blood."""
    f_mel = torch.logspace(-2, -0.5, _SAMPLES)
    f_blood = torch.logspace(-2, -1, _SAMPLES)
    grid = torch.cartesian_prod(f_mel, f_blood).to(decoder.camera.mean)
    return decoder.reflectance.bands(grid[:, 0], grid[:, 1])


def _at_least_float32(value: Tensor) -> Tensor:
    return value if value.dtype == torch.float64 else value.float()


class Reading(NamedTuple):
    """Maps, capture and reconstruction of photographs.

    Attributes:
        maps: Maps of skin.
        capture: Light and camera of each photograph.
        reconstruction: Photographs computed from maps and capture, in linear sRGB, not clipped.
        uncertainty: How uncertain the pigments are.
    """

    maps: SkinMaps
    capture: Capture
    reconstruction: Float[Tensor, "batch 3 height width"]
    uncertainty: Uncertainty


_MOST_LEVELS, _WIDEST, _LARGEST_SIZE = 8, 1024, 4096
"""Sizes of networks, beyond which a file would fill the memory before its weights are compared."""


def _is_count(value: Any, most: int) -> bool:
    return isinstance(value, int) and not isinstance(value, bool) and 1 <= value <= most


@dataclass(frozen=True)
class AutoencoderConfig:
    """Configuration of a `SkinAutoencoder`.

    Attributes:
        optics: Name of a preset of `SkinOptics`.
        widths: Channels of the encoder at each level.
        working_size: Longer side, in pixels, of the crops that the weights are trained on.
        white_balance_max: Largest error of the white balance that is estimated, in natural
            logarithms, beyond what is known of it.

    Raises:
        InputError: If a value is out of range, or no number.
    """

    optics: str = "measured"
    widths: tuple[int, ...] = WIDTHS
    working_size: int = 128
    white_balance_max: float = WHITE_BALANCE_MAX

    def __post_init__(self) -> None:
        levels = isinstance(self.widths, tuple) and 1 <= len(self.widths) <= _MOST_LEVELS
        if not levels or not all(_is_count(width, _WIDEST) for width in self.widths):
            raise InputError(
                f"widths holds 1 to {_MOST_LEVELS} whole numbers from 1 to {_WIDEST:,}; got "
                f"{_clip(self.widths)}."
            )
        if not _is_count(self.working_size, _LARGEST_SIZE):
            raise InputError(
                f"working_size is a whole number of pixels from 1 to {_LARGEST_SIZE:,}; got "
                f"{_clip(self.working_size)}."
            )
        largest = self.white_balance_max
        if (
            isinstance(largest, bool)
            or not isinstance(largest, int | float)
            or not 0 <= largest < 9
        ):
            raise InputError(
                f"white_balance_max is a number from 0, in logarithms; got {_clip(largest)}."
            )


class SkinAutoencoder(nn.Module):
    """Estimates maps of skin and the capture of photographs, and reconstructs the photographs.

    Photograph -> `SkinEncoder` -> output activations -> `SkinDecoder` -> photograph. One forward
    pass serves training, inference and export.

    Args:
        config: Sizes of the network and the optics of skin; the defaults are `AutoencoderConfig()`.

    Attributes:
        config: Configuration of the model.
        trained_on: One line on the training data, which is written into files of the model.
        sd_scale: Factors on the standard deviations of melanin and hemoglobin, of pixels in the
            first row and of faces in the second, for a face whose melanin is .05; they are
            calibrated after training.
        sd_by_tone: How the logarithms of these factors change with the natural logarithm of the
            face's melanin: coefficients of it and of its square.
        region_share: Of melanin and hemoglobin: how much of the variance that pixels have beyond
            that of the face remains in the mean of a region; calibrated after training.

    Source:
        Alotaibi & Smith, "BioFaceNet", BMVC 2019, for the idea of an encoder with a physical
        decoder.

    Example:
        >>> import torch
        >>> from skinnet import SkinAutoencoder
        >>> model = SkinAutoencoder.from_pretrained()
        >>> with torch.no_grad():
        ...     reading = model(torch.full((1, 3, 64, 64), 0.5))
        >>> reading.maps.melanin.shape
        torch.Size([1, 64, 64])
    """

    sd_scale: Tensor
    sd_by_tone: Tensor
    region_share: Tensor

    def __init__(self, config: AutoencoderConfig | None = None) -> None:
        super().__init__()
        self.config = config or AutoencoderConfig()
        self.trained_on = ""
        self.encoder = SkinEncoder(
            _MAP_CHANNELS, _GLOBAL_CHANNELS, self.config.widths, KNOWN_VALUES
        )
        self.decoder = SkinDecoder(self.config.optics)
        self.known = KnownCapture(self.decoder.camera, _sample_skin(self.decoder))
        self.register_buffer("sd_scale", torch.ones(2, 2))
        self.register_buffer("sd_by_tone", torch.zeros(2, 2, 2))
        self.register_buffer("region_share", torch.ones(2))

    @classmethod
    def from_pretrained(cls, path: str | Path | None = None) -> "SkinAutoencoder":
        """Load a trained model, in evaluation mode.

        Args:
            path: A .safetensors file, or a .ckpt of training. By default the shipped weights.

        Returns:
            The model, on the CPU.

        Raises:
            InputError: For a file that is missing, truncated, of another format or not of skinnet.

        Example:
            >>> from skinnet import SkinAutoencoder
            >>> SkinAutoencoder.from_pretrained().config.working_size
            160
        """
        file = SHIPPED_WEIGHTS if path is None else Path(path)
        saved = read_weights(file) if file.suffix == ".safetensors" else _read_model(file)
        with refuse_mismatch(file, saved.version):
            earlier = saved.format == EARLIER_FORMAT
            config = upgrade_config(saved.config) if earlier else saved.config
            model = cls(AutoencoderConfig(**{**config, "widths": tuple(config["widths"])}))
            own = model.state_dict()
            model.load_state_dict(upgrade_weights(saved.state, own) if earlier else saved.state)
        model.trained_on = saved.trained_on
        return model.eval()

    def save_pretrained(self, path: str | Path) -> None:
        """Write weights and configuration as one file, which `from_pretrained` reads.

        Args:
            path: The .safetensors file to write.
        """
        write_weights(self._saved(), Path(path))

    def describe(self) -> dict[str, Any]:
        """Describe the model in primitives, as checkpoints do.

        Returns:
            Format, version, optics, widths, working size, and the training data.
        """
        return _describe(self._saved())

    def make_checkpoint(self) -> dict[str, Any]:
        """Make a checkpoint of the model alone, which training cannot continue from.

        Returns:
            What `torch.save` writes and `from_pretrained` reads.
        """
        return _make_checkpoint(self._saved())

    def _saved(self) -> SavedModel:
        return SavedModel(asdict(self.config), self.trained_on, self.state_dict())

    def forward(
        self, photograph: Float[Tensor, "batch 3 height width"], known: Capture | None = None
    ) -> Reading:
        """Estimate maps and capture, and reconstruct the photographs.

        Args:
            photograph: Display sRGB in [0, 1].
            known: What is known of the capture of each photograph, with None or NaN for what is
                not; None: nothing.

        Returns:
            Maps, capture, reconstruction and uncertainty; the reconstruction is linear sRGB.
        """
        maps, capture, uncertainty = self.encode(photograph, known)
        return Reading(maps, capture, self.decode(maps, capture), uncertainty)

    def encode(
        self, photograph: Float[Tensor, "batch 3 height width"], known: Capture | None = None
    ) -> tuple[SkinMaps, Capture, Uncertainty]:
        """Estimate maps, capture and uncertainty; this half may run in lower precision.

        A photograph whose white balance, light or camera is known is read as if it had been taken
        with a perfect balance, under D65, by the mean camera.

        Args:
            photograph: Display sRGB in [0, 1].
            known: What is known of the capture of each photograph, with None or NaN for what is
                not; None: nothing.

        Returns:
            Maps, capture and uncertainty. What is known of the capture is returned as it is.

        Raises:
            InputError: The photographs have another shape, or values outside [0, 1].
        """
        _check_photograph(photograph)
        linear = rgb_to_linear_rgb(photograph)
        given = self.known.complete(known, photograph.shape[0], linear)
        normal = self.known.normalise(linear, given, self.decoder.camera)
        raw = self.encoder(to_display(normal), normal, self.known.describe(given))
        raw_maps, global_outputs = map(_at_least_float32, raw)
        capture = _activate_capture(global_outputs, self.config.white_balance_max)
        maps = _activate(raw_maps, linear)
        tone = measure_tone(maps.melanin.detach(), maps.mask.detach())
        factors = find_factors(tone, self.sd_scale, self.sd_by_tone)
        uncertainty = _activate_uncertainty(raw_maps, global_outputs, factors)
        return maps, self.known.adopt(given, capture), uncertainty

    def decode(self, maps: SkinMaps, capture: Capture) -> Float[Tensor, "batch 3 height width"]:
        """Reconstruct photographs from maps and capture; this half needs float32.

        Args:
            maps: Maps of skin.
            capture: Light and camera of each photograph.

        Returns:
            Linear sRGB, not clipped.

        Source:
            Equations 4 and 11 of Alotaibi & Smith 2017.
        """
        pixels = (maps.melanin, maps.hemoglobin, maps.shading, maps.specular, maps.offset)
        return self.decoder.compose(*pixels, capture)


def _check_photograph(photograph: Tensor) -> None:
    """Refuse what is no batch of photographs; nothing is checked while a graph is exported."""
    if torch.compiler.is_compiling():
        return
    if photograph.ndim != 4 or photograph.shape[1] != 3:
        raise InputError(
            "Photographs are a tensor [batch, 3, height, width]; got one of shape "
            f"{list(photograph.shape)}."
        )
    if not photograph.numel():
        return
    low, high = (float(bound) for bound in photograph.detach().aminmax())
    if low < -_ROUNDING or high > 1 + _ROUNDING:
        wrong = high if high > 1 + _ROUNDING else low
        hint = " Divide 8-bit values by 255." if wrong > 2 else ""
        raise InputError(f"Photographs have display sRGB in [0, 1]; got {wrong:g}.{hint}")
