"""The convolutional encoder: a photograph to raw maps and raw globals."""

from itertools import pairwise

import torch
import torch.nn.functional as F
from jaxtyping import Float
from torch import Tensor, nn

from skinnet.errors import InputError

WIDTHS = (16, 32, 64, 128, 160)


class SkinEncoder(nn.Module):
    """A U-Net with a shared trunk; its outputs get their meaning and range from `controls`.

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
        self.stem = _stage(3, widths[0], stride=1)
        pairs = list(pairwise(widths))
        self.down = nn.ModuleList(_stage(fine, coarse, stride=2) for fine, coarse in pairs)
        self.scene = nn.Sequential(nn.Linear(widths[-1], widths[-1]), nn.ReLU())
        self.globals = nn.Linear(widths[-1], globals)
        self.up = nn.ModuleList(_Merge(coarse, fine) for fine, coarse in reversed(pairs))
        self.head = nn.Sequential(_conv(widths[0] + 6, widths[0]), nn.Conv2d(widths[0], maps, 1))

    def forward(
        self,
        srgb: Float[Tensor, "batch 3 height width"],
        linear: Float[Tensor, "batch 3 height width"],
    ) -> tuple[Float[Tensor, "batch maps height width"], Float[Tensor, "batch globals"]]:
        """Raw maps and globals of display sRGB in [0, 1] and the same photograph in linear sRGB.

        The trunk sees display values, which are evenly spaced to the eye; the head sees both, so
        that what is not skin can be copied.
        """
        features = [self.stem(4 * srgb - 2)]
        for stage in self.down:
            features.append(stage(features[-1]))
        x = features.pop()
        scene = self.scene(x.mean((-2, -1)))
        x = x + scene[..., None, None]
        for merge in self.up:
            x = merge(x, features.pop())
        return self.head(torch.cat([x, srgb, linear], 1)), self.globals(scene)


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


def _conv(inputs: int, outputs: int, stride: int = 1) -> nn.Sequential:
    # Batch rather than group normalisation: it folds into the convolution on export.
    return nn.Sequential(
        nn.Conv2d(inputs, outputs, 3, stride, padding=1, bias=False),
        nn.BatchNorm2d(outputs),
        nn.ReLU(inplace=True),
    )
