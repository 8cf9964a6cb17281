"""The conditions under which a photograph was taken: its light and its camera."""

from typing import NamedTuple

import torch
from jaxtyping import Float
from torch import Tensor


class Capture(NamedTuple):
    """Light and camera of each photograph in a batch of any leading shape.

    Attributes:
        light: Convex weights of the lights in `LIGHTS`.
        temperature: Correlated colour temperature of the daylight among them, 4,000 to 25,000 K.
        camera: Coefficients of the camera basis, in standard deviations.
        white_balance: Natural logarithm of the error in R/G and in B/G; zero is perfect.

    Example:
        >>> import torch
        >>> from skinnet.physics import SpectralCamera
        >>> camera = SpectralCamera()
        >>> warm = camera.standard()._replace(temperature=torch.tensor(5000.0))
        >>> camera.matrix(warm).shape
        torch.Size([33, 3])
    """

    light: Float[Tensor, "*batch lights"]
    temperature: Float[Tensor, "*batch"]
    camera: Float[Tensor, "*batch components"]
    white_balance: Float[Tensor, "*batch 2"]

    def expand(self, batch: tuple[int, ...], dtype: torch.dtype) -> "Capture":
        """Repeat the capture for every photograph of a batch.

        Args:
            batch: Shape of the batch, to which the leading axes are broadcast.
            dtype: Precision of the result.

        Returns:
            The capture, with `batch` as its leading axes.
        """
        leading = self.temperature.ndim
        return Capture(
            *(value.to(dtype).expand((*batch, *value.shape[leading:])) for value in self)
        )

    @staticmethod
    def standard(
        lights: int, components: int, shape: tuple[int, ...] = (), like: Tensor | None = None
    ) -> "Capture":
        """Return daylight of 6,504 K (D65), the mean camera and a perfect white balance.

        Args:
            lights: Number of lights in a mixture.
            components: Number of components of the camera basis.
            shape: Leading axes.
            like: Tensor whose precision and device the capture has.

        Returns:
            The capture.
        """
        like = torch.empty(()) if like is None else like
        light = like.new_zeros(*shape, lights)
        light[..., 0] = 1
        return Capture(
            light,
            like.new_full(shape, 6504.0),
            like.new_zeros(*shape, components),
            like.new_zeros(*shape, 2),
        )
