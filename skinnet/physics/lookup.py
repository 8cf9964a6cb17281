"""Skin reflectance tabulated over the two pigment fractions."""

from typing import Any

import numpy as np
import torch
from jaxtyping import Float
from torch import Tensor, nn

from skinnet.physics._linear_algebra import apply_matrix
from skinnet.physics._pigment_axis import PigmentAxis
from skinnet.physics._table_sampling import extrapolate_ends, sample_table
from skinnet.physics.inversion import F_BLOOD_RANGE, F_MEL_RANGE, SkinInverse
from skinnet.physics.nuisance import Nuisance
from skinnet.physics.reflectance import SkinReflectance

_NODES = (128, 64)
"""Nodes in f_mel and f_blood."""

_BLOOD_SPACING = 0.8
"""Spacing of f_blood times the mean absorption of the dermis' blood in cm^-1; it balances the error
at small fractions against that at large ones."""


class SkinLookup(nn.Module):
    """Reflectance on a grid over [0, 1]^2 in (f_mel, f_blood), contracted to RGB and interpolated.

    Colour is linear in the spectrum. So a table of spectra times the 33 x 3 matrix of a light and a
    camera is a table of colours, and the 33 bands are never computed for each pixel. Nodes are at
    equal steps of log(1 + f / spacing), where `spacing` is about the fraction that absorbs half of
    the light. 0 and 1 are in the middle of the outermost cells, where a cell's gradient is right. A
    table of the same size spaced as u^3 has four times the error, and its gradient has no limit at
    zero.

    The table is stored unless one of the constants is a parameter. Then it is computed on every
    call, and gradients reach the constant.

    Args:
        reflectance: Skin to tabulate.
        nodes: Nodes in f_mel and in f_blood, at least 3.

    Attributes:
        reflectance: Skin that is tabulated.
        nodes: Nodes in f_mel and in f_blood.
        spacing: Spacing of f_mel and of f_blood.

    Source:
        Alotaibi & Smith 2017, section 4.4, precomputes such a table of colours.

    Example:
        >>> import torch
        >>> from skinnet.physics import SkinLookup, SkinReflectance, load_spectrum_to_srgb
        >>> lookup = SkinLookup(SkinReflectance())
        >>> matrix = load_spectrum_to_srgb("D65", "mean").float()
        >>> f_mel, f_blood = torch.full((1, 1, 1), 0.05), torch.full((1, 1, 1), 0.04)
        >>> sampled = lookup.sample(lookup.colours(matrix[None]), f_mel, f_blood)[0, :, 0, 0]
        >>> exact = lookup.reflectance(0.05, 0.04) @ matrix
        >>> bool((sampled - exact).abs().max() < 5e-4)
        True
    """

    table: Tensor

    def __init__(self, reflectance: SkinReflectance, nodes: tuple[int, int] = _NODES) -> None:
        super().__init__()
        self.reflectance = reflectance
        self.nodes = nodes
        self.register_load_state_dict_post_hook(_refresh)  # type: ignore[no-untyped-call]
        self.refresh()

    @torch.no_grad()
    def refresh(self) -> None:
        """Compute spacing and table again, after a constant was changed in place."""
        skin = self.reflectance
        melanin = 0.5 / float((skin.d_epd * skin.mu_mel).max().clamp_min(1e-3))
        d_base = skin.d_epd if skin.d_base is None else skin.d_base
        absorption = skin.mu_blood * (1 / _BLOOD_SPACING + 2 * skin.blood_epd * d_base)
        blood = 1 / float(absorption.mean().clamp_min(1e-3))
        self.spacing = (min(melanin, 1.0), min(blood, 1.0))
        self.register_buffer("table", self._tabulate(), persistent=False)

    def spectra(self) -> Float[Tensor, "mel blood wavelength"]:
        """Return the tabulated spectra.

        Returns:
            Reflectance at the nodes; at the outermost, outside [0, 1], it is extrapolated.
        """
        fixed = next(self.reflectance.parameters(), None) is None
        return self.table if fixed else self._tabulate()

    def _tabulate(
        self, nuisance: Nuisance | None = None
    ) -> Float[Tensor, "*batch mel blood wavelength"]:
        f_mel, f_blood = (self.fractions(axis) for axis in (0, 1))
        if nuisance is not None:
            nuisance = Nuisance(*(deviation[..., None, None] for deviation in nuisance))
        inner = self.reflectance.bands(f_mel[:, None], f_blood[None, :], nuisance)
        return extrapolate_ends(extrapolate_ends(inner, -3), -2)

    def _axis(self, axis: int) -> PigmentAxis:
        """Axis from 0 to 1, half a node after the first node of the table."""
        return PigmentAxis(0.0, 1.0, self.nodes[axis] - 1, self.spacing[axis])

    def fractions(self, axis: int) -> Float[Tensor, "nodes"]:
        """Return the fractions at which spectra are computed.

        Args:
            axis: 0 for f_mel, 1 for f_blood.

        Returns:
            0, the fractions of the inner nodes, and 1.
        """
        count = self.nodes[axis]
        position = (np.arange(count) - 0.5).clip(0, count - 2)
        return torch.from_numpy(self._axis(axis).fractions(position)).to(
            self.reflectance.wavelengths
        )

    def colours(
        self, matrix: Float[Tensor, "*batch wavelength 3"], nuisance: Nuisance | None = None
    ) -> Float[Tensor, "*batch 3 mel blood"]:
        """Compute tables of linear RGB, one for each image.

        With deviations the spectra are computed for each image, in the time that the closed form
        takes for as many pixels as the table has nodes.

        Args:
            matrix: Maps from reflectance to linear RGB, as `SpectralCamera.matrix`.
            nuisance: Deviations of each image's skin from the preset [*batch]; None: none.

        Returns:
            Linear RGB at the nodes.
        """
        if nuisance is not None:
            tables = self._tabulate(nuisance).to(matrix)
            return apply_matrix(tables, matrix).movedim(-1, -3)
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
        """Interpolate tables of colours bilinearly at the fractions of each pixel.

        Gradients of the fractions are interpolated on their own. For every preset but `printed`
        they are within 1 % of the closed form's at each pixel.

        Args:
            colours: One table for each image, from `colours`.
            f_mel: Melanosome volume fractions in [0, 1].
            f_blood: Blood volume fractions in [0, 1].

        Returns:
            Linear RGB.
        """
        grid = torch.stack([self._grid_coordinate(f_blood, 1), self._grid_coordinate(f_mel, 0)], -1)
        return sample_table(colours, grid)

    def inverse(
        self,
        matrix: Float[Tensor, "wavelength 3"],
        nodes: tuple[int, int] = (256, 256),
        f_mel: tuple[float, float] = F_MEL_RANGE,
        f_blood: tuple[float, float] = F_BLOOD_RANGE,
    ) -> SkinInverse:
        """Tabulate colours for inverse rendering under one light and camera.

        Args:
            matrix: Spectrum-to-RGB matrix of light, camera and colour transform.
            nodes: Nodes in f_mel and in f_blood.
            f_mel: Range of melanosome volume fractions.
            f_blood: Range of blood volume fractions.

        Returns:
            The inverse, for any number of colours.

        Raises:
            InputError: As `SkinInverse`.
        """
        return SkinInverse(self.reflectance, self.spacing, matrix, nodes, f_mel, f_blood)

    def _grid_coordinate(
        self, fraction: Float[Tensor, "*shape"], axis: int
    ) -> Float[Tensor, "*shape"]:
        """Coordinate of grid_sample: -1 at the first node, 1 at the last."""
        scale, shift = self._axis(axis).scale_and_shift
        per_node = 2 / (self.nodes[axis] - 1)
        # In place: an allocation the size of a map costs as much as the arithmetic on it.
        logarithm = torch.log(fraction + self.spacing[axis])
        return logarithm.mul_(per_node * scale).add_(per_node * (shift + 0.5) - 1)


def _refresh(lookup: SkinLookup, _: Any) -> None:
    lookup.refresh()
