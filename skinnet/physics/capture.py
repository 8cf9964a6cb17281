"""The conditions under which a photograph was taken: its light and its camera."""

from typing import NamedTuple

import torch
from jaxtyping import Float
from torch import Tensor


class Capture(NamedTuple):
    """Light and camera of each photograph in a batch of any leading shape.

    `light`: weights of `LIGHTS`, convex. `temperature`: of the daylight among them, in kelvin,
    4,000 to 25,000. `camera`: coefficients of the camera basis, in standard deviations.
    `white_balance`: natural logarithm of the error in R/G and in B/G; zero is perfect.
    """

    light: Float[Tensor, "*batch lights"]
    temperature: Float[Tensor, "*batch"]
    camera: Float[Tensor, "*batch components"]
    white_balance: Float[Tensor, "*batch 2"]

    def expand(self, batch: tuple[int, ...], dtype: torch.dtype) -> "Capture":
        """The same capture for every photograph of a batch of that shape."""
        leading = self.temperature.ndim
        return Capture(
            *(value.to(dtype).expand((*batch, *value.shape[leading:])) for value in self)
        )

    @staticmethod
    def standard(
        lights: int, components: int, shape: tuple[int, ...] = (), like: Tensor | None = None
    ) -> "Capture":
        """Daylight of 6,504 K (D65), the mean camera and a perfect white balance."""
        like = torch.empty(()) if like is None else like
        light = like.new_zeros(*shape, lights)
        light[..., 0] = 1
        return Capture(
            light,
            like.new_full(shape, 6504.0),
            like.new_zeros(*shape, components),
            like.new_zeros(*shape, 2),
        )
