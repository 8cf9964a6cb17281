"""Skin reflectance tabulated over the two pigment fractions."""

import math
from typing import Any

import torch
import torch.nn.functional as F
from jaxtyping import Float
from torch import Tensor, nn

from skinnet.physics.inversion import F_BLOOD_RANGE, F_MEL_RANGE, SkinInverse
from skinnet.physics.reflectance import SkinReflectance

NODES = (96, 64)
"""Nodes in f_mel and f_blood."""

BLOOD_SPACING = 0.8
"""Spacing of f_blood times the mean absorption of the dermis' blood in cm^-1; it balances the error
of the colour against that of its slope."""


class SkinLookup(nn.Module):
    """Reflectance on a grid over [0, 1]^2 in (f_mel, f_blood), contracted to RGB and interpolated.

    Colour is linear in the spectrum, so a table of spectra times the 33 x 3 matrix of a light and a
    camera is a table of colours, and the 33 bands are never made per pixel. Nodes stand at equal
    steps of log(1 + f / spacing), where `spacing` is about the fraction that absorbs half of the
    light: evenly below it, by ratio above it. 0 and 1 lie in the middle of the outermost cells, so
    that the slope there is that of a cell. A table of the same size spaced as u^3 has four times
    the error, and its slope has no limit at zero.

    The table is kept unless one of the constants is a parameter; then it is made on every call, and
    gradients reach the constant.
    """

    kept: Tensor

    def __init__(self, reflectance: SkinReflectance, nodes: tuple[int, int] = NODES):
        super().__init__()
        self.reflectance = reflectance
        self.nodes = nodes
        self.register_load_state_dict_post_hook(_refresh)  # type: ignore[no-untyped-call]
        self.refresh()

    @torch.no_grad()
    def refresh(self) -> None:
        """Make spacing and table again, after a constant was changed in place."""
        skin = self.reflectance
        melanin = 0.5 / float((skin.d_epd * skin.mu_mel).max().clamp_min(1e-3))
        d_base = skin.d_epd if skin.d_base is None else skin.d_base
        absorption = skin.mu_blood * (1 / BLOOD_SPACING + 2 * skin.blood_epd * d_base)
        blood = 1 / float(absorption.mean().clamp_min(1e-3))
        self.spacing = (min(melanin, 1.0), min(blood, 1.0))
        self.register_buffer("kept", self._tabulate(), persistent=False)

    def spectra(self) -> Float[Tensor, "mel blood wavelength"]:
        """Reflectance at the nodes; the outermost, outside [0, 1], are extrapolated."""
        fixed = next(self.reflectance.parameters(), None) is None
        return self.kept if fixed else self._tabulate()

    def _tabulate(self) -> Float[Tensor, "mel blood wavelength"]:
        f_mel, f_blood = (self.fractions(axis) for axis in (0, 1))
        inner = self.reflectance.bands(f_mel[:, None], f_blood[None, :])
        return _outer(_outer(inner).transpose(0, 1)).transpose(0, 1).contiguous()

    def fractions(self, axis: int) -> Float[Tensor, "nodes"]:
        """0, the inner nodes in f_mel (axis 0) or f_blood (axis 1), and 1."""
        count, spacing = self.nodes[axis], self.spacing[axis]
        step = (torch.arange(count, dtype=torch.float64) - 0.5).clamp(0, count - 2)
        fraction = spacing * torch.expm1(step / (count - 2) * math.log1p(1 / spacing))
        return fraction.to(self.reflectance.wavelengths)

    def colours(
        self, matrix: Float[Tensor, "*batch wavelength 3"]
    ) -> Float[Tensor, "*batch 3 mel blood"]:
        """Tables of linear RGB, one for each spectrum-to-RGB matrix."""
        spectra = self.spectra().to(matrix)
        # One product for the whole batch: a batched one would copy the spectra for each image.
        flat = matrix.mT.reshape(-1, matrix.shape[-2]) @ spectra.flatten(0, 1).mT
        return flat.reshape(*matrix.shape[:-2], 3, *self.nodes)

    def sample(
        self,
        colours: Float[Tensor, "batch 3 mel blood"],
        f_mel: Float[Tensor, "batch height width"],
        f_blood: Float[Tensor, "batch height width"],
    ) -> Float[Tensor, "batch 3 height width"]:
        """Bilinear interpolation of the tables at the fractions of each pixel."""
        grid = torch.stack([self._position(f_blood, 1), self._position(f_mel, 0)], -1)
        return F.grid_sample(colours, grid, align_corners=True, padding_mode="border")

    def inverse(
        self,
        matrix: Float[Tensor, "wavelength 3"],
        nodes: tuple[int, int] = (256, 256),
        f_mel: tuple[float, float] = F_MEL_RANGE,
        f_blood: tuple[float, float] = F_BLOOD_RANGE,
    ) -> SkinInverse:
        """From linear RGB under a light and a camera back to the fractions."""
        return SkinInverse(self.reflectance, self.spacing, matrix, nodes, f_mel, f_blood)

    def _position(self, fraction: Float[Tensor, "*shape"], axis: int) -> Float[Tensor, "*shape"]:
        """Place of a fraction among the nodes as grid_sample counts it, -1 at the first."""
        count, spacing = self.nodes[axis], self.spacing[axis]
        scale = 2 * (count - 2) / (count - 1) / math.log1p(1 / spacing)
        shift = 1 / (count - 1) - 1 - math.log(spacing) * scale
        # In place: an allocation the size of a map costs as much as the arithmetic on it.
        return torch.log(fraction + spacing).mul_(scale).add_(shift)


def _outer(values: Float[Tensor, "nodes *rest"]) -> Float[Tensor, "nodes *rest"]:
    """Values at 0, the inner nodes and 1 to values at all nodes: the first and last cell are the
    lines through their inner node and their middle, so nothing is evaluated outside [0, 1]."""
    first, last = 2 * values[:1] - values[1:2], 2 * values[-1:] - values[-2:-1]
    return torch.cat([first, values[1:-1], last])


def _refresh(lookup: SkinLookup, _: Any) -> None:
    lookup.refresh()
