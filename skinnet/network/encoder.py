"""The convolutional encoder: a photograph to its maps and its capture, without units yet."""

from itertools import pairwise

import torch
import torch.nn.functional as F
from jaxtyping import Float
from torch import Tensor, nn

from skinnet.errors import InputError

_WIDEST, _MOST_LEVELS = 1024, 8
WIDTHS = (24, 40, 80, 128, 160)
"""Channels of the U-Net at each level, finest first."""

_HEAD_CHANNELS = 24
"""Channels of the head, which alone works at the photograph's own resolution."""

_POOLED_COLOURS = 8
"""Attention maps, each of which pools one colour of the photograph."""

_ATTENTION_CHANNELS = 32
"""Channels from which attention and the expected chroma are computed."""

_PLACES, _PLACE_CHANNELS = 24, 128
"""Further attention maps whose pooled colours are compared with each other, and the channels of
that comparison."""

_PIXEL_CHANNELS = 9

_KNOWN_CHANNELS = 64
"""Channels of the layer that reads what is known of the capture."""

_DARKEST = 4e-3
"""Linear value that is added before a logarithm, which is infinite at zero."""


class SkinEncoder(nn.Module):
    """Computes raw maps and raw global values from a photograph of any size.

    A U-Net works from half the photograph's resolution down, and a head works at full resolution.
    The inputs of the head are display values, linear values and their logarithms, in which pigments
    are nearly linear. It is modulated by a context vector of the whole photograph, because the
    pigments of a colour depend on the light. The context compares the colours of places that the
    network attends to. A confidence-weighted vote on the light's tint is also added to the global
    values directly. `SkinAutoencoder` maps the outputs to physical ranges.

    Halvings round up, and features are resized to those of the level above. So no size is padded or
    cropped.

    Args:
        map_channels: Number of output maps.
        global_channels: Number of output values of the whole photograph.
        widths: Channels of the U-Net at each level, finest first.
        known_values: Number of values that describe what is known of a capture; 0 for none.

    Raises:
        InputError: If `widths` is empty.

    Source:
        Ronneberger et al. 2015 (U-Net); Perez et al. 2018 (FiLM, the modulation of the head); Hu et
        al. 2017 (FC4, the confidence-weighted vote).

    Example:
        >>> import torch
        >>> from skinnet import SkinEncoder
        >>> encoder = SkinEncoder(map_channels=5, global_channels=18, widths=(4, 8)).eval()
        >>> photograph = torch.rand(1, 3, 17, 33)
        >>> maps, global_outputs = encoder(photograph, photograph**2.2)
        >>> maps.shape, global_outputs.shape
        (torch.Size([1, 5, 17, 33]), torch.Size([1, 18]))
    """

    def __init__(
        self,
        map_channels: int,
        global_channels: int,
        widths: tuple[int, ...] = WIDTHS,
        known_values: int = 0,
    ) -> None:
        super().__init__()
        if not widths:
            raise InputError(
                f"widths holds the channels of one level or more, as {WIDTHS}; got ()."
            )
        if len(widths) > _MOST_LEVELS or not all(1 <= width <= _WIDEST for width in widths):
            raise InputError(
                f"widths holds up to {_MOST_LEVELS} numbers of channels from 1 to {_WIDEST}; got "
                f"{tuple(widths)}."
            )
        deepest = widths[-1]
        self.stem = _stage(3, widths[0], stride=2)
        pairs = list(pairwise(widths))
        self.down = nn.ModuleList(_stage(fine, coarse, stride=2) for fine, coarse in pairs)
        self.context = nn.Sequential(nn.Linear(2 * deepest, deepest), nn.ReLU())
        self.known = _make_known(known_values, deepest) if known_values else None
        self.broadcast = nn.Linear(deepest, deepest)
        self.pooling = _AttentionPooling(widths[0])
        self.refine = nn.Sequential(
            nn.Linear(deepest + 3 * _POOLED_COLOURS + 2, deepest),
            nn.ReLU(),
            nn.Linear(deepest, deepest),
        )
        self.places = _Places(widths[0], deepest)
        self.global_outputs = nn.Linear(deepest, global_channels)
        self.white_balance = nn.Linear(2, global_channels, bias=False)
        self.up = nn.ModuleList(_Merge(coarse, fine) for fine, coarse in reversed(pairs))
        self.head = _Head(widths[0], deepest, map_channels)

    def forward(
        self,
        srgb: Float[Tensor, "batch 3 height width"],
        linear: Float[Tensor, "batch 3 height width"],
        known: Float[Tensor, "batch known_values"] | None = None,
    ) -> tuple[
        Float[Tensor, "batch map_channels height width"], Float[Tensor, "batch global_channels"]
    ]:
        """Compute raw maps and raw global values.

        Args:
            srgb: Photographs in display sRGB, in [0, 1].
            linear: The same photographs in linear sRGB.
            known: What is known of each capture; None: nothing.

        Returns:
            Raw maps and raw global values, unbounded and without unit.
        """
        features = [self.stem(4 * srgb - 2)]
        for stage in self.down:
            features.append(stage(features[-1]))
        x = features.pop()
        context = self.context(torch.cat([x.mean((-2, -1)), x.amax((-2, -1))], 1))
        if self.known is not None and known is not None:
            context = context + self.known(known)
        x = x + self.broadcast(context)[..., None, None]
        for merge in self.up:
            x = merge(x, features.pop())
        log = torch.log(linear + _DARKEST)
        colours, tint = self.pooling(x, log)
        context = context + self.refine(torch.cat([context, colours, tint], 1))
        context = context + self.places(x, log)
        pixel = torch.cat([srgb, linear, 0.5 * log], 1)
        global_outputs = self.global_outputs(context) + self.white_balance(tint)
        return self.head(pixel, x, context), global_outputs


class _AttentionPooling(nn.Module):
    """Mean log colours under attention, and a confidence-weighted vote on the light's tint.

    The white of an eye, a shirt or a grey wall shows the white balance, which an average of
    features blurs. The network predicts the chroma that each pixel has under neutral light. The
    pixel's chroma minus this prediction is its vote, weighted by a predicted confidence (Hu et al.
    2017, FC4).
    """

    def __init__(self, features: int) -> None:
        super().__init__()
        self.conv = nn.Conv2d(features + 3, _ATTENTION_CHANNELS, 3, padding=1)
        self.attention = nn.Conv2d(_ATTENTION_CHANNELS, _POOLED_COLOURS + 1, 1)
        self.expected_chroma = nn.Conv2d(_ATTENTION_CHANNELS, 2, 1)

    def forward(
        self,
        features: Float[Tensor, "batch f h w"],
        log: Float[Tensor, "batch 3 height width"],
    ) -> tuple[Float[Tensor, "batch colours"], Float[Tensor, "batch 2"]]:
        """Pooled log colours, and log R/G and log B/G of the light in units of a tenth."""
        small = F.interpolate(log, size=features.shape[-2:], mode="bilinear")
        x = self.conv(torch.cat([features, small], 1)).relu()
        attention = self.attention(x).flatten(2).softmax(-1).float()
        weights, confidence = attention.split([_POOLED_COLOURS, 1], 1)
        chroma = 10 * (small[:, ::2] - small[:, 1:2]) - self.expected_chroma(x)
        tint = (confidence * chroma.flatten(2)).sum(-1)
        return _pool_colours(weights, small), tint


def _pool_colours(
    weights: Float[Tensor, "batch places pixels"], log: Float[Tensor, "batch 3 h w"]
) -> Float[Tensor, "batch colours"]:
    # Sums rather than matrix products, which autocast would compute with eight bits of precision.
    return (weights[:, :, None] * log.flatten(2)[:, None]).sum(-1).flatten(1)


class _Places(nn.Module):
    """Compares the colours of places in a photograph, such as skin, the whites of eyes, and cloth.

    What a face's colour says of its pigments depends on the colours around it. Nothing is added to
    the context until this part is trained.
    """

    def __init__(self, features: int, context: int) -> None:
        super().__init__()
        self.conv = nn.Conv2d(features + 3, _ATTENTION_CHANNELS, 3, padding=1)
        self.attention = nn.Conv2d(_ATTENTION_CHANNELS, _PLACES, 1)
        last = _make_zero(_PLACE_CHANNELS, context)
        self.compare = nn.Sequential(nn.Linear(3 * _PLACES, _PLACE_CHANNELS), nn.ReLU(), last)

    def forward(
        self,
        features: Float[Tensor, "batch f h w"],
        log: Float[Tensor, "batch 3 height width"],
    ) -> Float[Tensor, "batch context"]:
        small = F.interpolate(log, size=features.shape[-2:], mode="bilinear")
        x = self.conv(torch.cat([features, small], 1)).relu()
        weights = self.attention(x).flatten(2).softmax(-1).float()
        compared: Tensor = self.compare(_pool_colours(weights, small))
        return compared


class _Head(nn.Module):
    """Maps of a pixel from its colour and the features around it, modulated by the context.

    The modulation is FiLM (Perez et al. 2018).
    """

    def __init__(self, features: int, context: int, map_channels: int) -> None:
        super().__init__()
        self.conv = nn.Conv2d(_PIXEL_CHANNELS, _HEAD_CHANNELS, 3, padding=1, bias=False)
        self.project = nn.Conv2d(features, _HEAD_CHANNELS, 1, bias=False)
        self.norm = nn.Sequential(nn.BatchNorm2d(_HEAD_CHANNELS), nn.ReLU(inplace=True))
        self.modulate = nn.Linear(context, 2 * _HEAD_CHANNELS)
        self.deepen = _conv(_HEAD_CHANNELS, _HEAD_CHANNELS, size=1)
        self.last = nn.Conv2d(_HEAD_CHANNELS, map_channels, 1)

    def forward(
        self,
        pixel: Float[Tensor, "batch c height width"],
        features: Float[Tensor, "batch f h w"],
        context: Float[Tensor, "batch s"],
    ) -> Float[Tensor, "batch map_channels height width"]:
        # Projected before it is enlarged, which is the same and four times cheaper.
        around = F.interpolate(self.project(features), size=pixel.shape[-2:], mode="bilinear")
        mixed = self.norm(self.conv(pixel) + around)
        scale, shift = self.modulate(context)[..., None, None].chunk(2, 1)
        maps: Tensor = self.last(self.deepen(mixed * (1 + scale) + shift))
        return maps


class _Merge(nn.Module):
    """Coarse features, resized and added to the features of a finer level."""

    def __init__(self, coarse: int, fine: int) -> None:
        super().__init__()
        self.project = nn.Conv2d(coarse, fine, 1)
        self.mix = _conv(fine, fine)

    def forward(
        self, coarse: Float[Tensor, "batch c h w"], fine: Float[Tensor, "batch f H W"]
    ) -> Float[Tensor, "batch f H W"]:
        up = F.interpolate(self.project(coarse), size=fine.shape[-2:], mode="bilinear")
        mixed: Tensor = self.mix(up + fine)
        return mixed


def _make_known(values: int, context: int) -> nn.Sequential:
    """A part that adds nothing to the context until it is trained."""
    last = _make_zero(_KNOWN_CHANNELS, context)
    return nn.Sequential(nn.Linear(values, _KNOWN_CHANNELS), nn.ReLU(), last)


def _make_zero(inputs: int, outputs: int) -> nn.Linear:
    """A layer whose output is zero until it is trained."""
    layer = nn.Linear(inputs, outputs)
    nn.init.zeros_(layer.weight)
    nn.init.zeros_(layer.bias)
    return layer


def _stage(inputs: int, outputs: int, stride: int) -> nn.Sequential:
    return nn.Sequential(_conv(inputs, outputs, stride), _conv(outputs, outputs))


def _conv(inputs: int, outputs: int, stride: int = 1, size: int = 3) -> nn.Sequential:
    # Batch rather than group normalisation: it folds into the convolution on export.
    return nn.Sequential(
        nn.Conv2d(inputs, outputs, size, stride, padding=size // 2, bias=False),
        nn.BatchNorm2d(outputs),
        nn.ReLU(inplace=True),
    )
