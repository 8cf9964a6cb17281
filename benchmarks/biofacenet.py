"""A network of the shape of BioFaceNet, with random weights, to compare run times.

Alotaibi & Smith, BMVC 2019: a U-Net of five levels, 32 to 512 filters, three convolutions a level,
with four decoders (melanin, hemoglobin, shading, specular) on one encoder and a fully connected
head for light and camera. Written from the paper's description.
"""

import torch
import torch.nn.functional as F
from torch import Tensor, nn

FILTERS = (32, 64, 128, 256, 512)


class BioFaceNetShape(nn.Module):
    """Computes four maps and 15 globals from float32 [batch, 3, height, width]."""

    def __init__(self) -> None:
        super().__init__()
        inputs = (3, *FILTERS[:-1])
        self.down = nn.ModuleList(_make_level(a, b) for a, b in zip(inputs, FILTERS, strict=True))
        self.decoders = nn.ModuleList(_Decoder() for _ in range(4))
        self.globals = nn.Linear(FILTERS[-1], 15)

    def forward(self, image: Tensor) -> tuple[Tensor, ...]:
        """Compute the maps and the globals."""
        features = [self.down[0](image)]
        for level in self.down[1:]:
            features.append(level(F.max_pool2d(features[-1], 2)))
        maps = [decoder(features) for decoder in self.decoders]
        return (*maps, self.globals(features[-1].mean((-2, -1))))


class _Decoder(nn.Module):
    def __init__(self) -> None:
        super().__init__()
        pairs = zip(FILTERS[:0:-1], FILTERS[-2::-1], strict=True)
        self.up = nn.ModuleList(_make_level(coarse + fine, fine) for coarse, fine in pairs)
        self.last = nn.Conv2d(FILTERS[0], 1, 3, padding=1)

    def forward(self, features: list[Tensor]) -> Tensor:
        x = features[-1]
        for level, skip in zip(self.up, features[-2::-1], strict=True):
            x = level(torch.cat([F.interpolate(x, scale_factor=2.0, mode="bilinear"), skip], 1))
        last: Tensor = self.last(x)
        return last


def _make_level(inputs: int, outputs: int) -> nn.Sequential:
    layers: list[nn.Module] = []
    for count in (inputs, outputs, outputs):
        layers += [nn.Conv2d(count, outputs, 3, padding=1), nn.BatchNorm2d(outputs), nn.ReLU()]
    return nn.Sequential(*layers)
