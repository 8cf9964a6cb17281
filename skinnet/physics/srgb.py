"""The colour space sRGB: its primaries and its luminance (IEC 61966-2-1)."""

from jaxtyping import Float
from torch import Tensor

from skinnet.physics.camera import srgb_to_xyz


def luminance(
    linear: Float[Tensor, "*batch 3 height width"],
) -> Float[Tensor, "*batch 1 height width"]:
    """Weigh the channels of linear sRGB into relative luminance, CIE's Y.

    The weights are .2126, .7152 and .0722, not those of video (.299, .587, .114), which belong to
    signals that are not linear.

    Args:
        linear: Linear sRGB; white is (1, 1, 1).

    Returns:
        Luminance relative to white, 1 for white; of any size and sign where the input is.

    Source:
        IEC 61966-2-1, the second row of the matrix from linear sRGB to XYZ.

    Example:
        >>> import torch
        >>> green = torch.tensor([0.0, 1.0, 0.0])[:, None, None]
        >>> round(luminance(green).item(), 4)
        0.7152
    """
    weights = srgb_to_xyz()[1].to(linear)
    return (linear * weights[:, None, None]).sum(-3, keepdim=True)
