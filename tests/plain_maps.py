"""Maps and captures of one value everywhere."""

import torch

from skinnet.network import SkinMaps
from skinnet.physics import Capture


def maps(**changes: torch.Tensor) -> SkinMaps:
    plain = torch.full((2, 8, 8), 0.05)
    found = SkinMaps(
        plain, plain, torch.ones(2, 8, 8), 0 * plain, torch.zeros(2, 3, 8, 8), torch.ones(2, 8, 8)
    )
    return found._replace(**changes)


def capture(camera: float = 0.0, balance: float = 0.0) -> Capture:
    return Capture(
        torch.full((2, 9), 1 / 9),
        torch.full((2,), 6500.0),
        torch.full((2, 6), camera),
        torch.full((2, 2), balance),
    )
