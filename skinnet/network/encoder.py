"""The convolutional encoder: a photograph to raw maps and raw globals."""

from itertools import pairwise

import torch
import torch.nn.functional as F
from jaxtyping import Float
from torch import Tensor, nn

from skinnet.errors import InputError

WIDTHS = (24, 40, 80, 128, 160)

HEAD = 24
"""Channels of the head, which alone works at the photograph's own resolution."""

GATHERED = 8
"""Places in the photograph whose colours the scene is told."""

VOTING = 32
"""Channels from which attention, and the chroma that a place should have, are read."""

_PIXEL = 9
_DARKEST = 4e-3


class SkinEncoder(nn.Module):
    """A U-Net from half the photograph's resolution down, and a head at its own.

    The head sees display values, linear ones and their logarithms, in which pigments are nearly
    linear, and is modulated by what the deepest level makes of the whole scene: how a colour reads
    depends on the light. What votes make of the light's tint reaches the globals directly as well.
    Outputs get their meaning and range from `controls`.

    Any size from 1 x 1 up: halvings round up, and features are brought to the size of the level
    above, so nothing is padded or cropped. `maps` and `globals` are the numbers of output channels
    and `widths` the channels of each level.
    """

    def __init__(self, maps: int, globals: int, widths: tuple[int, ...] = WIDTHS):
        super().__init__()
        if not widths:
            raise InputError(
                f"widths holds the channels of one level or more, as {WIDTHS}; got ()."
            )
        deepest = widths[-1]
        self.stem = _stage(3, widths[0], stride=2)
        pairs = list(pairwise(widths))
        self.down = nn.ModuleList(_stage(fine, coarse, stride=2) for fine, coarse in pairs)
        self.scene = nn.Sequential(nn.Linear(2 * deepest, deepest), nn.ReLU())
        self.back = nn.Linear(deepest, deepest)
        self.gather = _Gather(widths[0])
        self.weigh = nn.Sequential(
            nn.Linear(deepest + 3 * GATHERED + 2, deepest), nn.ReLU(), nn.Linear(deepest, deepest)
        )
        self.globals = nn.Linear(deepest, globals)
        self.balanced = nn.Linear(2, globals, bias=False)
        self.up = nn.ModuleList(_Merge(coarse, fine) for fine, coarse in reversed(pairs))
        self.head = _Head(widths[0], deepest, maps)

    def forward(
        self,
        srgb: Float[Tensor, "batch 3 height width"],
        linear: Float[Tensor, "batch 3 height width"],
    ) -> tuple[Float[Tensor, "batch maps height width"], Float[Tensor, "batch globals"]]:
        """Raw maps and globals of display sRGB in [0, 1] and the same photograph in linear sRGB."""
        features = [self.stem(4 * srgb - 2)]
        for stage in self.down:
            features.append(stage(features[-1]))
        x = features.pop()
        scene = self.scene(torch.cat([x.mean((-2, -1)), x.amax((-2, -1))], 1))
        x = x + self.back(scene)[..., None, None]
        for merge in self.up:
            x = merge(x, features.pop())
        log = torch.log(linear + _DARKEST)
        colours, balance = self.gather(x, log)
        scene = scene + self.weigh(torch.cat([scene, colours, balance], 1))
        pixel = torch.cat([srgb, linear, 0.5 * log], 1)
        return self.head(pixel, x, scene), self.globals(scene) + self.balanced(balance)


class _Gather(nn.Module):
    """The mean log colours of places that the network attends to, and the light's tint.

    The white of an eye, a shirt or a grey wall tells the white balance, which an average of
    features blurs. Each place has the chroma that it should have taken off its own, and a vote as
    strong as the network trusts it (Hu et al. 2017, FC4).
    """

    def __init__(self, features: int):
        super().__init__()
        self.look = nn.Conv2d(features + 3, VOTING, 3, padding=1)
        self.attend = nn.Conv2d(VOTING, GATHERED + 1, 1)
        self.expect = nn.Conv2d(VOTING, 2, 1)

    def forward(
        self,
        features: Float[Tensor, "batch f h w"],
        log: Float[Tensor, "batch 3 height width"],
    ) -> tuple[Float[Tensor, "batch gathered"], Float[Tensor, "batch 2"]]:
        """Colours of the places, and the votes' log R/G and log B/G in units of a tenth."""
        small = F.interpolate(log, size=features.shape[-2:], mode="bilinear")
        seen = self.look(torch.cat([features, small], 1)).relu()
        attention = self.attend(seen).flatten(2).softmax(-1).float()
        places, voters = attention.split([GATHERED, 1], 1)
        chroma = 10 * (small[:, ::2] - small[:, 1:2]) - self.expect(seen)
        # Sums, for matrix products would run in the trunk's precision, and light in an image is
        # known to better than eight bits.
        colours = (places[:, :, None] * small.flatten(2)[:, None]).sum(-1)
        return colours.flatten(1), (voters * chroma.flatten(2)).sum(-1)


class _Head(nn.Module):
    """A pixel and the features around it to its maps, modulated by the scene (FiLM, Perez et al.
    2018)."""

    def __init__(self, features: int, scene: int, maps: int):
        super().__init__()
        self.look = nn.Conv2d(_PIXEL, HEAD, 3, padding=1, bias=False)
        self.project = nn.Conv2d(features, HEAD, 1, bias=False)
        self.mixed = nn.Sequential(nn.BatchNorm2d(HEAD), nn.ReLU(inplace=True))
        self.modulate = nn.Linear(scene, 2 * HEAD)
        self.deepen = _conv(HEAD, HEAD, size=1)
        self.last = nn.Conv2d(HEAD, maps, 1)

    def forward(
        self,
        pixel: Float[Tensor, "batch c height width"],
        features: Float[Tensor, "batch f h w"],
        scene: Float[Tensor, "batch s"],
    ) -> Float[Tensor, "batch maps height width"]:
        # Projected before it is enlarged, which is the same and four times cheaper.
        around = F.interpolate(self.project(features), size=pixel.shape[-2:], mode="bilinear")
        mixed = self.mixed(self.look(pixel) + around)
        scale, shift = self.modulate(scene)[..., None, None].chunk(2, 1)
        maps: Tensor = self.last(self.deepen(mixed * (1 + scale) + shift))
        return maps


class _Merge(nn.Module):
    """Features of a coarse level brought to a finer one and added to what was kept there."""

    def __init__(self, coarse: int, fine: int):
        super().__init__()
        self.project = nn.Conv2d(coarse, fine, 1)
        self.mix = _conv(fine, fine)

    def forward(
        self, coarse: Float[Tensor, "batch c h w"], fine: Float[Tensor, "batch f H W"]
    ) -> Float[Tensor, "batch f H W"]:
        up = F.interpolate(self.project(coarse), size=fine.shape[-2:], mode="bilinear")
        mixed: Tensor = self.mix(up + fine)
        return mixed


def _stage(inputs: int, outputs: int, stride: int) -> nn.Sequential:
    return nn.Sequential(_conv(inputs, outputs, stride), _conv(outputs, outputs))


def _conv(inputs: int, outputs: int, stride: int = 1, size: int = 3) -> nn.Sequential:
    # Batch rather than group normalisation: it folds into the convolution on export.
    return nn.Sequential(
        nn.Conv2d(inputs, outputs, size, stride, padding=size // 2, bias=False),
        nn.BatchNorm2d(outputs),
        nn.ReLU(inplace=True),
    )
