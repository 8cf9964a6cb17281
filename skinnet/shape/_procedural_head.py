"""A procedural head: a star-shaped surface with bumps for its features.

The surface is one radius per direction from the middle of the head, so an equirectangular chart in
azimuth and elevation covers the face without a seam. The unit is half a head: crown and chin lie
one unit above and below the eyes. x points to the face's left, y up, z forward.
"""

import torch
from jaxtyping import Float
from torch import Tensor

CHART_EXTENT = (2.0, 1.5)
"""Largest azimuth and elevation of the chart, in radians."""

# Azimuth and elevation, their widths (radians), and height (half heads). A feature off the middle
# is on both sides.
_BUMPS: dict[str, tuple[float, float, float, float, float]] = {
    "bridge": (0.0, -0.10, 0.09, 0.20, 0.09),
    "tip": (0.0, -0.33, 0.11, 0.10, 0.19),
    "wing": (0.12, -0.38, 0.06, 0.06, 0.06),
    "brow": (0.28, 0.17, 0.20, 0.07, 0.03),
    "socket": (0.34, 0.02, 0.14, 0.09, -0.05),
    "eyeball": (0.34, 0.01, 0.09, 0.06, 0.025),
    "cheek": (0.48, -0.28, 0.20, 0.16, 0.03),
    "upper_lip": (0.0, -0.60, 0.19, 0.045, 0.035),
    "mouth": (0.0, -0.66, 0.20, 0.02, -0.025),
    "lower_lip": (0.0, -0.72, 0.17, 0.05, 0.035),
    "chin": (0.0, -1.02, 0.25, 0.14, 0.07),
    "jaw": (0.75, -0.85, 0.25, 0.20, 0.03),
    "ear": (1.50, -0.08, 0.10, 0.20, 0.10),
}

_AXES = (0.69, 1.0, 0.90)
ROUNDNESS = 2.6
"""Exponent of the superellipsoid under the features."""

IDENTITY_SIZE = len(_BUMPS) * 3 + len(_AXES) + 1
"""Number of identity numbers of a head: three a feature, four for the superellipsoid."""


def compute_chart_angles(
    rows: int, columns: int
) -> tuple[Float[Tensor, "1 columns"], Float[Tensor, "rows 1"]]:
    """Compute the azimuth and elevation of each texel of the chart.

    Args:
        rows: Texels along the chart's height.
        columns: Texels along its width.

    Returns:
        Azimuths of the columns, from the face's right to its left, and elevations of the rows, from
        the top down, in radians.

    Example:
        >>> from skinnet.shape._procedural_head import compute_chart_angles
        >>> azimuth, elevation = compute_chart_angles(3, 5)
        >>> azimuth
        tensor([[-2., -1.,  0.,  1.,  2.]])
    """
    azimuth = torch.linspace(-CHART_EXTENT[0], CHART_EXTENT[0], columns)[None, :]
    elevation = torch.linspace(CHART_EXTENT[1], -CHART_EXTENT[1], rows)[:, None]
    return azimuth, elevation


def compute_head_radius(
    identity: Float[Tensor, "batch identity"], rows: int, columns: int
) -> Float[Tensor, "batch 1 rows columns"]:
    """Compute the radius of bald heads over the chart.

    Args:
        identity: 43 numbers per head, standard normal over people; zeros give the mean head.
        rows: Texels along the chart's height.
        columns: Texels along its width.

    Returns:
        Radius in half heads, of the dtype of `identity`.

    Example:
        >>> import torch
        >>> from skinnet.shape._procedural_head import compute_head_radius
        >>> radius = compute_head_radius(torch.zeros(1, 43), 61, 81)
        >>> round(radius.max().item(), 2)  # the tip of the nose
        1.17
    """
    azimuth, elevation = (axis.to(identity) for axis in compute_chart_angles(rows, columns))
    numbers = identity[:, : -len(_AXES) - 1].unflatten(1, (len(_BUMPS), 3))
    radius = _compute_ellipsoid(identity[:, -len(_AXES) - 1 :], azimuth, elevation)
    return (radius + _compute_bumps(numbers, azimuth, elevation))[:, None]


def _compute_ellipsoid(
    numbers: Float[Tensor, "batch 4"], azimuth: Tensor, elevation: Tensor
) -> Float[Tensor, "batch rows columns"]:
    a, b, c = (numbers.new_tensor(_AXES) * (1 + 0.05 * numbers[:, :3])).unbind(1)
    taper = (0.16 + 0.04 * numbers[:, 3, None, None]) * (-elevation).clamp_min(0)
    x, y, z = _compute_direction(azimuth, elevation).abs() ** ROUNDNESS
    widths = (a[:, None, None] * (1 - taper), b[:, None, None], c[:, None, None])
    radius = torch.zeros_like(x)
    for axis, width in zip((x, y, z), widths, strict=True):
        radius = radius + axis * width.pow(-ROUNDNESS)
    return radius.pow(-1 / ROUNDNESS)


def _compute_bumps(
    numbers: Float[Tensor, "batch bumps 3"], azimuth: Tensor, elevation: Tensor
) -> Float[Tensor, "batch rows columns"]:
    at, level, width, tall, height = numbers.new_tensor(list(_BUMPS.values())).T[..., None]
    scale, up, wide = numbers[..., None].unbind(2)
    # A bump off the middle is on both sides; the nearer one counts.
    across = torch.where(at > 0, azimuth.abs() - at, azimuth) / (width * (1 + 0.12 * wide))
    along = (elevation.T - level - 0.025 * up) / tall
    profile = height * (1 + 0.3 * scale) * torch.exp(-(along**2) / 2)
    return torch.matmul(profile.mT, torch.exp(-(across**2) / 2))


def _compute_direction(azimuth: Tensor, elevation: Tensor) -> Float[Tensor, "3 rows columns"]:
    x, y = elevation.cos() * azimuth.sin(), elevation.sin().expand(-1, azimuth.shape[1])
    return torch.stack([x, y, elevation.cos() * azimuth.cos()])
