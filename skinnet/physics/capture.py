"""The conditions under which a photograph was taken: its light and its camera."""

from collections.abc import Callable
from typing import NamedTuple

import torch
from jaxtyping import Float
from torch import Tensor


class Capture(NamedTuple):
    """Light and camera of each photograph in a batch of any leading shape.

    Rendering needs the first four. As an input of a network, None and NaN mean what is not known.

    Attributes:
        light: Convex weights of the lights in `LIGHTS`.
        temperature: Correlated colour temperature of the daylight among them, 4,000 to 25,000 K.
        camera: Coefficients of the camera basis, in standard deviations.
        white_balance: Natural logarithm of the error in R/G and in B/G, of the camera's balanced
            channels; zero is perfect.
        linear: 1 for a photograph in linear light, such as a developed RAW file without a tone
            curve, before sRGB's own curve; otherwise 0. Rendering ignores it.
        exposure: Natural logarithm of the luminance, in linear sRGB, that a white diffuser in the
            light of the skin has in the photograph. Rendering ignores it.

    Example:
        >>> import torch
        >>> from skinnet.physics import SpectralCamera
        >>> camera = SpectralCamera()
        >>> warm = camera.standard()._replace(temperature=torch.tensor(5000.0))
        >>> camera.matrix(warm).shape
        torch.Size([33, 3])
    """

    # Typed as tensors although None is allowed: all but a network's inputs are complete.
    light: Float[Tensor, "*batch lights"] = None  # type: ignore[assignment]
    temperature: Float[Tensor, "*batch"] = None  # type: ignore[assignment]
    camera: Float[Tensor, "*batch components"] = None  # type: ignore[assignment]
    white_balance: Float[Tensor, "*batch 2"] = None  # type: ignore[assignment]
    linear: Float[Tensor, "*batch"] | None = None
    exposure: Float[Tensor, "*batch"] | None = None

    def expand(self, batch: tuple[int, ...], dtype: torch.dtype) -> "Capture":
        """Repeat the capture for every photograph of a batch.

        Args:
            batch: Shape of the batch, to which the leading axes are broadcast.
            dtype: Precision of the result.

        Returns:
            The capture, with `batch` as its leading axes.
        """
        leading = self.temperature.ndim
        return self.map(lambda value: value.to(dtype).expand((*batch, *value.shape[leading:])))

    def map(self, function: Callable[[Tensor], Tensor]) -> "Capture":
        """Apply a function to every tensor; what is None stays None.

        Args:
            function: Function of one tensor.

        Returns:
            The capture of its results.
        """
        parts = {name: value for name, value in self._asdict().items() if value is not None}
        return Capture(**{name: function(value) for name, value in parts.items()})

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
