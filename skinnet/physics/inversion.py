"""Inverse rendering: from colours back to pigment fractions, through a table of skin colours."""

import copy
from typing import NamedTuple

import numpy as np
import torch
from jaxtyping import Bool, Float, Shaped
from torch import Tensor

from skinnet.errors import InputError
from skinnet.physics._colour_posterior import ColourPosteriors, flatten_colours
from skinnet.physics._colour_surface import ColourSurface
from skinnet.physics._pigment_axis import PigmentAxis
from skinnet.physics.nearest_colour import NearestColour
from skinnet.physics.posterior import Posterior
from skinnet.physics.prior import SkinPrior
from skinnet.physics.reflectance import SkinReflectance

F_MEL_RANGE = (0.0, 0.43)
"""Melanosome volume fractions that the encoder can predict and that a table covers by default."""

F_BLOOD_RANGE = (0.0, 0.15)
"""Blood volume fractions that the encoder can predict and that a table covers by default.

Table 1 of the paper has .02 to .07. The middle 90 % of measured forearms have .018 to .074, lips
have more, and a fraction that is clipped is lost.
"""

_TOLERANCE = 0.02
"""Distance in linear RGB within which a colour is on the manifold. It is about three steps of 8-bit
sRGB on pale skin. The colours of measured spectra differ by about as much from the model's."""

_COLOURS_AT_A_TIME, _ROWS_AT_A_TIME = 1 << 14, 16


class Inversion(NamedTuple):
    """Pigment fractions of colours, and what the fractions leave unexplained.

    A colour that is NaN, infinite or beyond 1e6 gives NaN, and is not on the manifold.

    Attributes:
        f_mel: Melanosome volume fraction, within the table's range.
        f_blood: Blood volume fraction, within the table's range.
        offset: Colour minus the model's colour, linear RGB (delta of equation 11).
        on_manifold: Whether the offset is within the tolerance and no fraction beyond the table
            would bring the model closer.
    """

    f_mel: Float[Tensor, "*shape"]
    f_blood: Float[Tensor, "*shape"]
    offset: Float[Tensor, "*shape 3"]
    on_manifold: Bool[Tensor, "*shape"]


class SkinInverse:
    """Inverse rendering by a look-up table of colours. `SkinLookup.inverse` constructs it.

    The nearest node in linear RGB is the paper's answer. Beyond the paper, Newton's steps go on
    from the node to the closest point of the surface through the table, which has the colours of
    the closed form at the nodes and halfway between them. It runs on the CPU in NumPy, without
    gradients.

    Args:
        reflectance: Skin whose colours are tabulated.
        spacing: Spacing of f_mel and of f_blood, as `SkinLookup.spacing`.
        matrix: Spectrum-to-RGB matrix of light, camera and colour transform.
        nodes: Nodes in f_mel and in f_blood, at least 2.
        f_mel: Range of melanosome volume fractions, in [0, 1].
        f_blood: Range of blood volume fractions, in [0, 1].

    Attributes:
        colours: The table [mel, blood, 3], linear RGB.

    Raises:
        InputError: For a range outside [0, 1], too few nodes, or a matrix that is zero or not
            finite.

    Source:
        Alotaibi & Smith 2017, section 4.4.

    Example:
        >>> from skinnet.physics import SkinLookup, SkinReflectance, load_spectrum_to_srgb
        >>> matrix = load_spectrum_to_srgb("D65", "Nikon D200")
        >>> lookup = SkinLookup(SkinReflectance(dtype=matrix.dtype))
        >>> rgb = lookup.reflectance(0.08, 0.04) @ matrix
        >>> found = lookup.inverse(matrix, nodes=(64, 64))(rgb)
        >>> round(found.f_mel.item(), 3), round(found.f_blood.item(), 3), found.on_manifold.item()
        (0.08, 0.04, True)
    """

    def __init__(
        self,
        reflectance: SkinReflectance,
        spacing: tuple[float, float],
        matrix: Float[Tensor, "wavelength 3"],
        nodes: tuple[int, int] = (256, 256),
        f_mel: tuple[float, float] = F_MEL_RANGE,
        f_blood: tuple[float, float] = F_BLOOD_RANGE,
    ) -> None:
        names = ("f_mel", "f_blood")
        for name, (low, high), count in zip(names, (f_mel, f_blood), nodes, strict=True):
            _check_axis(name, low, high, count)
        if not matrix.isfinite().all() or not matrix.any():
            raise InputError(
                "The spectrum-to-RGB matrix is zero, NaN or infinite; check its light."
            )
        self._mel = PigmentAxis(*f_mel, nodes[0], spacing[0])
        self._blood = PigmentAxis(*f_blood, nodes[1], spacing[1])
        exact = copy.deepcopy(reflectance).to("cpu", torch.float64)
        double = matrix.detach().to("cpu", torch.float64)
        self._posteriors = ColourPosteriors(exact, double)
        half_steps = _tabulate_half_steps(exact, double, self._mel, self._blood)
        self.colours = torch.from_numpy(half_steps[::2, ::2].copy())
        self._nearest = NearestColour(half_steps[::2, ::2])
        self._nodes = np.ascontiguousarray(half_steps[::2, ::2].reshape(-1, 3).T)
        self._surface = ColourSurface(half_steps)

    def __call__(
        self,
        rgb: Shaped[Tensor, "*shape channels"],
        refine: bool = True,
        tolerance: float = _TOLERANCE,
    ) -> Inversion:
        """Find the fractions of colours.

        Args:
            rgb: Linear RGB [*shape, 3], of any size and sign.
            refine: Whether to go on from the nearest node to the closest point of the surface;
                otherwise the result is the node, as in the paper.
            tolerance: Distance in linear RGB within which a colour is on the manifold.

        Returns:
            Fractions and offsets, in the precision and on the device of `rgb`, float32 at least.

        Raises:
            InputError: Unless the last axis holds R, G and B in floating point.
        """
        colours, where = flatten_colours(rgb)
        flat, usable = colours.numpy(), where.numpy()
        columns = np.full((6, len(flat)), np.nan, flat.dtype)
        columns[5] = False
        columns[:, usable] = self._invert(flat if usable.all() else flat[usable], refine, tolerance)
        f_mel, f_blood, *offset, on_manifold = (
            torch.from_numpy(column).reshape(rgb.shape[:-1]).to(rgb.device) for column in columns
        )
        return Inversion(f_mel, f_blood, torch.stack(offset, -1), on_manifold.bool())

    def posterior(
        self,
        rgb: Shaped[Tensor, "*shape channels"],
        noise: float = 0.005,
        white_balance: float = 0.02,
        prior: SkinPrior | None = None,
    ) -> Posterior:
        """Infer melanin and blood with their uncertainty, over all skins that a colour can be of.

        Skins with the same melanin and blood differ in oxygenation, scattering, baseline and
        thickness, and by what the model leaves over. Each skin's colours are normal about its mean;
        the posterior is `SkinPrior` times their density. It is tabulated over the colours of skin
        and interpolated; a table is kept for the next call with the same noise and prior. A colour
        is that of the skin itself, as in `__call__`: without the surface reflection of the
        measured spectra that the prior was fitted to.

        Args:
            rgb: Linear RGB [*shape, 3], of any size and sign.
            noise: Standard deviation of each channel, linear RGB, in [0, .5]. The default is that
                of a small camera's photograph in 8 bits.
            white_balance: Standard deviation of R/G and of B/G, relative, in [0, .5]. .02 is that
                of a good estimate; photographs of one person under unknown light differ by .2.
            prior: Distribution of skins; None: that of the preset `measured`.

        Returns:
            Means, standard deviations and gains, in the precision and on the device of `rgb`,
            float32 at least.

        Raises:
            InputError: Unless the last axis holds R, G and B in floating point; for a standard
                deviation out of its range; for constants other than those of the prior.

        Source:
            Bayes' theorem; the means and covariances of colours are Arasaratnam & Haykin's 2009.

        Example:
            >>> import torch
            >>> from skinnet.physics import SkinLookup, SkinReflectance, load_spectrum_to_srgb
            >>> matrix = load_spectrum_to_srgb("D65", "mean")
            >>> inverse = SkinLookup(SkinReflectance()).inverse(matrix, nodes=(8, 8))
            >>> found = inverse.posterior(torch.tensor([[0.45, 0.29, 0.22], [0.08, 0.04, 0.025]]))
            >>> found.is_skin.tolist(), found.blood_is_prior.tolist()
            ([True, True], [False, True])
        """
        return self._posteriors(rgb, noise, white_balance, prior)

    def _invert(
        self, colours: Float[np.ndarray, "colours 3"], refine: bool, tolerance: float
    ) -> Float[np.ndarray, "6 colours"]:
        """Fractions, offset and on_manifold, one a row."""
        nearest = self._nearest(colours)
        surface, nodes = self._surface.to(colours.dtype), self._nodes.astype(colours.dtype)
        result = np.empty((6, len(colours)), colours.dtype)
        for start in range(0, len(colours), _COLOURS_AT_A_TIME):
            part = slice(start, start + _COLOURS_AT_A_TIME)
            position = np.stack(np.divmod(nearest[part], self._blood.nodes)).astype(colours.dtype)
            block = np.ascontiguousarray(colours[part].T)
            offset = block - nodes.take(nearest[part], 1)
            if refine:
                position, offset = _refine(surface, block, position, offset)
            result[0, part] = self._mel.fractions(position[0])
            result[1, part] = self._blood.fractions(position[1])
            result[2:5, part] = offset
            # The best point may be half a step from the nearest node: this is not out of range.
            slack = 0.0 if refine else 0.5
            result[5, part] = _is_on_manifold(surface, position, offset, tolerance, slack)
        return result


def _refine(
    surface: ColourSurface,
    colours: Float[np.ndarray, "3 points"],
    position: Float[np.ndarray, "2 points"],
    offset: Float[np.ndarray, "3 points"],
) -> tuple[Float[np.ndarray, "2 points"], Float[np.ndarray, "3 points"]]:
    """Position and offset of the closest points; those of the node where the steps diverged."""
    closest = surface.project(colours, position)
    refined = colours - surface.evaluate(closest)
    better = (refined**2).sum(0) <= (offset**2).sum(0)
    return np.where(better, closest, position), np.where(better, refined, offset)


def _is_on_manifold(
    surface: ColourSurface,
    position: Float[np.ndarray, "2 points"],
    offset: Float[np.ndarray, "3 points"],
    tolerance: float,
    slack: float,
) -> Bool[np.ndarray, "points"]:
    """Whether offsets are within the tolerance and do not point to fractions beyond the table.

    At the table's border an offset has a component along the surface, outward. A tenth of the
    tolerance is allowed, and `slack` steps.
    """
    on_manifold = np.asarray((offset**2).sum(0) <= tolerance**2)
    outward = np.where(position <= 0, -1, 0) + np.where(position >= surface.last, 1, 0)
    border = np.flatnonzero(on_manifold & outward.any(0))
    derivatives = surface.differentiate(position[:, border])
    tangents = derivatives.row, derivatives.column
    for sign, tangent, other in zip(outward[:, border], tangents, tangents[::-1], strict=True):
        share = (tangent * other).sum(0) / ((other**2).sum(0) + np.finfo(other.dtype).tiny)
        across = tangent - share * other
        length = np.sqrt((across**2).sum(0)) + np.finfo(other.dtype).tiny
        beyond = sign * (offset[:, border] * across).sum(0) / length
        on_manifold[border] &= beyond <= tolerance / 10 + slack * length
    return on_manifold


def _check_axis(name: str, low: float, high: float, nodes: int = 2) -> None:
    if not 0 <= low < high <= 1:
        raise InputError(
            f"The range of {name} is two volume fractions in [0, 1], the lower first; got "
            f"({low:g}, {high:g}). Was it given in percent?"
        )
    if nodes < 2:
        raise InputError(f"A table has at least 2 nodes of {name}; got {nodes}.")


@torch.no_grad()
def _tabulate_half_steps(
    exact: SkinReflectance,
    matrix: Float[Tensor, "wavelength 3"],
    mel: PigmentAxis,
    blood: PigmentAxis,
) -> Float[np.ndarray, "mel blood 3"]:
    """Colours at the nodes and halfway between them, in float64."""
    f_mel, f_blood = (
        torch.from_numpy(axis.fractions(np.arange(0, axis.nodes - 0.75, 0.5)))
        for axis in (mel, blood)
    )
    # A few rows at a time: allocating the spectra of a whole table takes as long as computing them.
    rows = [exact.bands(part[:, None], f_blood) @ matrix for part in f_mel.split(_ROWS_AT_A_TIME)]
    return torch.cat(rows).numpy()
