"""The input of a training step."""

from typing import NamedTuple

from torch import Tensor

from skinnet.network import SkinMaps
from skinnet.physics import Capture


class Batch(NamedTuple):
    """Photographs and what is known of them.

    Attributes:
        photograph: Display sRGB in [0, 1], [batch, 3, height, width].
        mask: Probability of skin, true or estimated, [batch, height, width].
        truth: True maps, of rendered pictures only.
        capture: True light and camera, of rendered pictures only.
        albedo: Linear sRGB of the skin itself, of rendered pictures only.
        paired: Whether the second half of the batch shows the photographs of the first half in
            another exposure and white balance.
    """

    photograph: Tensor
    mask: Tensor
    truth: SkinMaps | None = None
    capture: Capture | None = None
    albedo: Tensor | None = None
    paired: bool = False
