"""What a training step is given."""

from typing import NamedTuple

from torch import Tensor

from skinnet.network.autoencoder import SkinMaps
from skinnet.physics import Capture


class Batch(NamedTuple):
    """Photographs in display sRGB [batch, 3, height, width], and what is known of them.

    `mask` is the skin mask, true or estimated. `truth`, `capture` and `albedo`, the linear sRGB of
    the skin itself, are there for rendered portraits only. With `twice` the second half of the
    batch shows the photographs of the first again, brighter or darker, warmer or colder.
    """

    photograph: Tensor
    mask: Tensor
    truth: SkinMaps | None = None
    capture: Capture | None = None
    albedo: Tensor | None = None
    twice: bool = False
