"""Inverse rendering: from colours back to pigment fractions, through a table of skin colours."""

import copy
from typing import NamedTuple

import numpy as np
import torch
from jaxtyping import Bool, Float, Shaped
from torch import Tensor

from skinnet.errors import InputError
from skinnet.physics._colour_surface import ColourSurface
from skinnet.physics._pigment_axis import PigmentAxis
from skinnet.physics._posterior_nodes import tabulate_nodes
from skinnet.physics._posterior_table import REACH, PosteriorTable
from skinnet.physics.nearest_colour import NearestColour
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

_MAX_COLOUR = 1e6
"""A colour with a larger value gives NaN, as does one that is NaN."""

_COLOURS_AT_A_TIME, _ROWS_AT_A_TIME = 1 << 14, 16

_LEAST_GAIN = 0.25
"""Gain below which a posterior is called the prior: a correlation of one half."""

_MAX_NOISE, _TABLES = 0.5, 4
"""Largest standard deviation of a colour, and number of posterior tables that are kept."""


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


class Posterior(NamedTuple):
    """What a colour says about melanin and blood, and how much more than `SkinPrior` says.

    A gain is 1 less the variance of ln f given the colour over its variance in the prior: 0 where
    the colour says nothing, 1 where it says all. The prior of blood is that of skins with the
    melanin that the colour shows. The posterior is about log-normal.

    A colour that is NaN or infinite, or is no skin's, gives NaN.

    Attributes:
        f_mel: Mean of the melanosome volume fraction.
        f_blood: Mean of the blood volume fraction.
        f_mel_sd: Standard deviation of f_mel.
        f_blood_sd: Standard deviation of f_blood.
        f_mel_gain: Share of the prior's variance of ln f_mel that the colour removes, at most 1.
        f_blood_gain: The same of ln f_blood, given melanin.
        mel_is_prior: Whether f_mel is little more than the prior's: its gain is below .25, so the
            colour lowers the standard deviation by less than 13 %, and among skins with the same
            prior the mean correlates with the truth by less than one half.
        blood_is_prior: The same of f_blood.
        is_skin: Whether a skin of the prior has a colour within five standard deviations.
    """

    f_mel: Float[Tensor, "*shape"]
    f_blood: Float[Tensor, "*shape"]
    f_mel_sd: Float[Tensor, "*shape"]
    f_blood_sd: Float[Tensor, "*shape"]
    f_mel_gain: Float[Tensor, "*shape"]
    f_blood_gain: Float[Tensor, "*shape"]
    mel_is_prior: Bool[Tensor, "*shape"]
    blood_is_prior: Bool[Tensor, "*shape"]
    is_skin: Bool[Tensor, "*shape"]


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
        self._reflectance = copy.deepcopy(reflectance).to("cpu", torch.float64)
        self._matrix = matrix.detach().to("cpu", torch.float64)
        self._posteriors: list[tuple[tuple[float, float, SkinPrior | None], PosteriorTable]] = []
        half_steps = _tabulate_half_steps(self._reflectance, self._matrix, self._mel, self._blood)
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
        _check_colours(rgb)
        dtype = torch.promote_types(rgb.dtype, torch.float32)
        flat = rgb.detach().to("cpu", dtype).reshape(-1, 3).numpy()
        usable = (np.abs(flat) < _MAX_COLOUR).all(1)
        columns = np.full((6, len(flat)), np.nan, flat.dtype)
        columns[5] = False
        columns[:, usable] = self._invert(flat if usable.all() else flat[usable], refine, tolerance)
        f_mel, f_blood, *offset, on_manifold = (
            torch.from_numpy(column).reshape(rgb.shape[:-1]).to(rgb.device) for column in columns
        )
        return Inversion(f_mel, f_blood, torch.stack(offset, -1), on_manifold.bool())

    @torch.no_grad()
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
        and interpolated; a table is kept for the next call with the same noise and prior. The
        surface reflection of measured spectra is not part of a colour here, as in `__call__`.

        Args:
            rgb: Linear RGB [*shape, 3], of any size and sign.
            noise: Standard deviation of each channel, linear RGB, in [0, .5]. The default is that
                of a small camera's photograph in 8 bits.
            white_balance: Standard deviation of R/G and of B/G, relative, in [0, .5]. Of .02 is a
                good estimate; two photographs of one person differ by .2 where nothing is known of
                the light.
            prior: Distribution of skins; None: that of the preset `measured`.

        Returns:
            Means, standard deviations and gains, in the precision and on the device of `rgb`,
            float32 at least.

        Raises:
            InputError: Unless the last axis holds R, G and B in floating point; for a standard
                deviation out of its range; for constants other than those of the prior.

        Source:
            Bayes' theorem; on the nuisance see Kennedy & O'Hagan 2001.

        Example:
            >>> import torch
            >>> from skinnet.physics import SkinLookup, SkinReflectance, load_spectrum_to_srgb
            >>> matrix = load_spectrum_to_srgb("D65", "mean")
            >>> inverse = SkinLookup(SkinReflectance()).inverse(matrix, nodes=(8, 8))
            >>> found = inverse.posterior(torch.tensor([[0.45, 0.29, 0.22], [0.08, 0.04, 0.025]]))
            >>> found.is_skin.tolist(), found.blood_is_prior.tolist()
            ([True, True], [False, True])
        """
        _check_colours(rgb)
        for name, value in (("noise", noise), ("white_balance", white_balance)):
            if not 0 <= value <= _MAX_NOISE:
                raise InputError(
                    f"{name} is a standard deviation in [0, {_MAX_NOISE:g}]; got {value:g}."
                )
        dtype = torch.promote_types(rgb.dtype, torch.float32)
        flat = rgb.detach().to("cpu", dtype).reshape(-1, 3)
        usable = (flat.abs() < _MAX_COLOUR).all(1)
        table = self._tabulate_posterior(noise, white_balance, prior)
        found = table(torch.where(usable[:, None], flat, 0.0))
        is_skin = usable & (found[6] <= REACH)
        found[:, ~is_skin] = torch.nan
        values = [row.to(rgb.device, dtype).reshape(rgb.shape[:-1]) for row in found]
        f_mel, f_mel_sd, f_mel_gain, f_blood, f_blood_sd, f_blood_gain, _ = values
        return Posterior(
            f_mel,
            f_blood,
            f_mel_sd,
            f_blood_sd,
            f_mel_gain,
            f_blood_gain,
            f_mel_gain < _LEAST_GAIN,
            f_blood_gain < _LEAST_GAIN,
            is_skin.to(rgb.device).reshape(rgb.shape[:-1]),
        )

    def _tabulate_posterior(
        self, noise: float, white_balance: float, prior: SkinPrior | None
    ) -> PosteriorTable:
        """Return a table of an earlier call with the same arguments, or a new one."""
        key = (noise, white_balance, prior)
        for other, table in self._posteriors:
            if other[:2] == key[:2] and other[2] is prior:
                return table
        if prior is None:
            _check_constants(self._reflectance)
        some = SkinPrior() if prior is None else prior
        nodes = tabulate_nodes(self._reflectance, self._matrix, some, noise, white_balance)
        self._posteriors = [*self._posteriors[1 - _TABLES :], (key, PosteriorTable(nodes))]
        return self._posteriors[-1][1]

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


def _check_axis(name: str, low: float, high: float, nodes: int) -> None:
    if not 0 <= low < high <= 1:
        raise InputError(
            f"The range of {name} is two volume fractions in [0, 1], the lower first; got "
            f"({low:g}, {high:g}). Was it given in percent?"
        )
    if nodes < 2:
        raise InputError(f"A table has at least 2 nodes of {name}; got {nodes}.")


def _check_colours(rgb: Tensor) -> None:
    if rgb.ndim == 0 or rgb.shape[-1] != 3 or not rgb.is_floating_point():
        raise InputError(
            f"Colours are linear RGB in floating point, with R, G and B in the last axis; got "
            f"{rgb.dtype} of shape {tuple(rgb.shape)}."
        )


def _check_constants(reflectance: SkinReflectance) -> None:
    """Refuse a skin that is not the one whose fits to measured spectra made the prior."""
    measured = dict(SkinReflectance("measured", dtype=torch.float64).named_buffers())
    own = {**dict(reflectance.named_parameters()), **dict(reflectance.named_buffers())}
    other = [
        name
        for name, value in measured.items()
        if name not in own or not torch.allclose(own[name], value, rtol=1e-5, atol=0)
    ]
    if other or own.keys() - measured.keys():
        raise InputError(
            "SkinPrior is the distribution of skins with the constants of the preset `measured`; "
            f"this skin differs in {', '.join(other or sorted(own.keys() - measured.keys()))}. "
            "Use that preset, or hand in a prior that was fitted with these constants."
        )


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
