"""What varies from skin to skin besides melanin and blood."""

from typing import NamedTuple

import torch
from jaxtyping import Float
from torch import Tensor


class Nuisance(NamedTuple):
    """Deviations of a skin from the constants of its preset, for skins of any leading shape.

    All zero is the preset. `SkinPrior` has their distribution, whose mean is another: measured
    skins scatter more than the preset, and the more so the darker they are.

    Attributes:
        thickness: Natural logarithm of the thickness of the dermis over the preset's `d_pd`.
        scattering: Natural logarithm of the scattering of the dermis over the preset's.
        oxygenation: Difference from the preset's `f_oxy`; the sum is clipped to [0, 1].
        baseline: Natural logarithm of the baseline absorption over the preset's.

    Example:
        >>> import torch
        >>> from skinnet.physics import Nuisance, SkinReflectance
        >>> skin = SkinReflectance()
        >>> thin = Nuisance.zeros()._replace(thickness=torch.tensor(-1.0))
        >>> bool((skin(0.05, 0.04, thin) < skin(0.05, 0.04)).all())  # light is lost below
        True
    """

    thickness: Float[Tensor, "*#batch"]
    scattering: Float[Tensor, "*#batch"]
    oxygenation: Float[Tensor, "*#batch"]
    baseline: Float[Tensor, "*#batch"]

    @staticmethod
    def zeros(shape: tuple[int, ...] = (), like: Tensor | None = None) -> "Nuisance":
        """Return the preset itself.

        Args:
            shape: Leading axes.
            like: Tensor whose precision and device the result has.

        Returns:
            Zeros.
        """
        like = torch.empty(()) if like is None else like
        return Nuisance(*(like.new_zeros(shape) for _ in Nuisance._fields))
