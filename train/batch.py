"""The input of a training step."""

from typing import NamedTuple

from torch import Tensor

from skinnet.network import SkinMaps
from skinnet.physics import Capture


class People(NamedTuple):
    """What is known of photographs whose second half shows the people of the first half again.

    Attributes:
        regions: Number of the region of each pixel, from 1; 0 is none, [batch, height, width].
        colour: Log R/G, log B/G and log luminance of the skin in the photographs before any change,
            in linear sRGB, [batch, 3].
        factors: Natural logarithms of factors by which melanin and hemoglobin are to be multiplied
            in the photographs before they are read, [batch, 2]; None: they stay.
    """

    regions: Tensor
    colour: Tensor
    factors: Tensor | None = None


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
        known: What the network is told of the captures, NaN where nothing; None: nothing.
        people: What is known of photographs of the same people; None: they show others.
    """

    photograph: Tensor
    mask: Tensor
    truth: SkinMaps | None = None
    capture: Capture | None = None
    albedo: Tensor | None = None
    paired: bool = False
    known: Capture | None = None
    people: People | None = None
