"""The colour space sRGB: its primaries, luminance and transfer curve (IEC 61966-2-1)."""

import torch
from jaxtyping import Float
from kornia.color import linear_rgb_to_rgb
from torch import Tensor

from skinnet.physics._linear_algebra import invert_3x3


def srgb_to_xyz() -> Float[Tensor, "3 3"]:
    """Compute the matrix from linear sRGB to XYZ.

    Returns:
        The matrix from the primaries and the D65 white, not rounded, float64.

    Source:
        IEC 61966-2-1.

    Example:
        >>> from skinnet.physics import srgb_to_xyz
        >>> [round(value, 4) for value in srgb_to_xyz().sum(1).tolist()]  # XYZ of white
        [0.9505, 1.0, 1.0891]
    """
    primaries = torch.tensor([[0.64, 0.33], [0.30, 0.60], [0.15, 0.06]], dtype=torch.float64)
    white = torch.tensor([0.3127, 0.3290], dtype=torch.float64)
    xyz = _chromaticity_to_xyz(primaries).mT
    return xyz * (invert_3x3(xyz) @ _chromaticity_to_xyz(white))


def _chromaticity_to_xyz(xy: Float[Tensor, "*batch 2"]) -> Float[Tensor, "*batch 3"]:
    x, y = xy.unbind(-1)
    return torch.stack([x / y, torch.ones_like(x), (1 - x - y) / y], -1)


def luminance(
    linear: Float[Tensor, "*batch 3 height width"],
) -> Float[Tensor, "*batch 1 height width"]:
    """Compute the relative luminance, CIE's Y, of linear sRGB.

    The weights are .2126, .7152 and .0722, not those of video (.299, .587, .114), which belong to
    signals that are not linear.

    Args:
        linear: Linear sRGB; white is (1, 1, 1).

    Returns:
        Luminance relative to white, not clipped; 1 for white.

    Source:
        IEC 61966-2-1, the second row of the matrix from linear sRGB to XYZ.

    Example:
        >>> import torch
        >>> from skinnet.physics import luminance
        >>> green = torch.tensor([0.0, 1.0, 0.0])[:, None, None]
        >>> round(luminance(green).item(), 4)
        0.7152
    """
    weights = srgb_to_xyz()[1].to(linear)
    return (linear * weights[:, None, None]).sum(-3, keepdim=True)


def to_display(
    linear: Float[Tensor, "*batch 3 height width"],
) -> Float[Tensor, "*batch 3 height width"]:
    """Encode linear sRGB for display, with sRGB's transfer curve.

    Args:
        linear: Linear sRGB; values outside [0, 1] are clipped.

    Returns:
        Display sRGB in [0, 1].

    Source:
        IEC 61966-2-1.

    Example:
        >>> import torch
        >>> from skinnet.physics import to_display
        >>> round(to_display(torch.full((3, 1, 1), 0.18)).mean().item(), 4)
        0.4614
    """
    display: Tensor = linear_rgb_to_rgb(linear.clamp(0, 1))
    return display
