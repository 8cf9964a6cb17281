"""Colours back to pigment fractions, through a table of the skin's colours."""

import copy
import math
from typing import NamedTuple

import numpy as np
import torch
from jaxtyping import Bool, Float, Shaped
from torch import Tensor

from skinnet.errors import InputError
from skinnet.physics._colour_surface import Surface
from skinnet.physics.nearest_colour import NearestColour
from skinnet.physics.reflectance import SkinReflectance

F_MEL_RANGE = (0.0, 0.43)
F_BLOOD_RANGE = (0.0, 0.15)
"""Where a table is made: what the encoder's maps can hold. The paper's Table 1 has .01 to .43 and
.02 to .07; but the middle 90 % of measured forearms hold 1.8 to 7.4 % of blood and lips hold more,
and a fraction that is clipped is lost. From zero on, hardly any colour asks for less."""

TOLERANCE = 0.02
"""Distance in linear RGB within which a colour is skin's: some three steps of 8 bits, and what two
parameters leave over of a measured spectrum."""

LARGEST = 1e6
"""A colour beyond is taken for damage, as is one that is not a number."""

_COLOURS, _ROWS = 1 << 14, 16


class Inversion(NamedTuple):
    """What colours say about the skin.

    `f_mel`, `f_blood`: volume fractions, within the table's range. `offset`: linear RGB of the
    colour minus the model's (delta of the paper's equation 11). `on_manifold`: the offset is within
    the tolerance, and the colour does not ask for fractions beyond the table. A colour that is NaN,
    infinite or beyond 1e6 gives NaN, and is not on the manifold.
    """

    f_mel: Float[Tensor, "*shape"]
    f_blood: Float[Tensor, "*shape"]
    offset: Float[Tensor, "*shape 3"]
    on_manifold: Bool[Tensor, "*shape"]


class Axis(NamedTuple):
    """Nodes of a fraction, at even steps of log(1 + f / spacing) as those of `SkinLookup`."""

    low: float
    high: float
    nodes: int
    spacing: float

    def fractions(self, place: Float[np.ndarray, "*shape"]) -> Float[np.ndarray, "*shape"]:
        """Fractions at places counted in nodes from the first."""
        first = math.log1p(self.low / self.spacing)
        step = (math.log1p(self.high / self.spacing) - first) / (self.nodes - 1)
        fraction = self.spacing * np.expm1(first + step * place)
        return fraction.clip(self.low, self.high).astype(place.dtype)


class SkinInverse:
    """Inverse rendering by a table of colours (Alotaibi & Smith 2017, section 4.4).

    The nearest node in linear RGB is the one that a search through all of them finds. Beyond the
    paper, Newton's steps go on from it to the nearest point of the surface itself, which has the
    closed form's colours at the nodes and halfway between them.

    `colours` [mel, blood, 3] is the table. Runs on the CPU in NumPy; nothing has a gradient.
    """

    def __init__(
        self,
        reflectance: SkinReflectance,
        spacing: tuple[float, float],
        matrix: Float[Tensor, "wavelength 3"],
        nodes: tuple[int, int] = (256, 256),
        f_mel: tuple[float, float] = F_MEL_RANGE,
        f_blood: tuple[float, float] = F_BLOOD_RANGE,
    ):
        """Raises `InputError` for a range outside [0, 1], too few nodes, or a bad `matrix`."""
        names = ("f_mel", "f_blood")
        for name, (low, high), count in zip(names, (f_mel, f_blood), nodes, strict=True):
            _check(name, low, high, count)
        if not matrix.isfinite().all() or not matrix.any():
            raise InputError(
                "The spectrum-to-RGB matrix is zero, NaN or infinite; check its light."
            )
        self.mel, self.blood = (
            Axis(*f_mel, nodes[0], spacing[0]),
            Axis(*f_blood, nodes[1], spacing[1]),
        )
        halves = _halves(reflectance, matrix, self.mel, self.blood)
        self.colours = torch.from_numpy(halves[::2, ::2].copy())
        self._nearest = NearestColour(halves[::2, ::2])
        self._nodes = np.ascontiguousarray(halves[::2, ::2].reshape(-1, 3).T)
        self._surface = Surface(halves)

    def __call__(
        self,
        rgb: Shaped[Tensor, "*shape channels"],
        refine: bool = True,
        tolerance: float = TOLERANCE,
    ) -> Inversion:
        """Fractions of linear RGB [*shape, 3], of any size and sign.

        `refine` goes on from the nearest node to the surface. Results have the precision and the
        device of `rgb`, float32 at least. Raises `InputError` unless the last axis holds R, G, B.
        """
        if rgb.ndim == 0 or rgb.shape[-1] != 3 or not rgb.is_floating_point():
            raise InputError(
                f"Colours are linear RGB in floating point, with R, G and B in the last axis; got "
                f"{rgb.dtype} of shape {tuple(rgb.shape)}."
            )
        dtype = torch.promote_types(rgb.dtype, torch.float32)
        flat = rgb.detach().to("cpu", dtype).reshape(-1, 3).numpy()
        usable = (np.abs(flat) < LARGEST).all(1)
        found = np.full((6, len(flat)), np.nan, flat.dtype)
        found[5] = False
        found[:, usable] = self._invert(flat if usable.all() else flat[usable], refine, tolerance)
        f_mel, f_blood, *offset, on = (
            torch.from_numpy(row).reshape(rgb.shape[:-1]).to(rgb.device) for row in found
        )
        return Inversion(f_mel, f_blood, torch.stack(offset, -1), on.bool())

    def _invert(
        self, colours: Float[np.ndarray, "colours 3"], refine: bool, tolerance: float
    ) -> Float[np.ndarray, "6 colours"]:
        nearest = self._nearest(colours)
        surface, nodes = self._surface.to(colours.dtype), self._nodes.astype(colours.dtype)
        found = np.empty((6, len(colours)), colours.dtype)
        for start in range(0, len(colours), _COLOURS):
            part = slice(start, start + _COLOURS)
            place = np.stack(np.divmod(nearest[part], self.blood.nodes)).astype(colours.dtype)
            some = np.ascontiguousarray(colours[part].T)
            offset = some - nodes.take(nearest[part], 1)
            if refine:
                place, offset = _refined(surface, some, place, offset)
            found[0, part] = self.mel.fractions(place[0])
            found[1, part] = self.blood.fractions(place[1])
            found[2:5, part] = offset
            # Of a node the offset may ask for half a step more without asking for another node.
            found[5, part] = _on(surface, place, offset, tolerance, 0.0 if refine else 0.5)
        return found


def _refined(
    surface: Surface,
    colours: Float[np.ndarray, "3 points"],
    place: Float[np.ndarray, "2 points"],
    offset: Float[np.ndarray, "3 points"],
) -> tuple[Float[np.ndarray, "2 points"], Float[np.ndarray, "3 points"]]:
    """Foot and offset of colours; those of the node where the steps have led farther away."""
    foot = surface.foot(colours, place)
    from_foot = colours - surface.colour(foot)
    closer = (from_foot**2).sum(0) <= (offset**2).sum(0)
    return np.where(closer, foot, place), np.where(closer, from_foot, offset)


def _on(
    surface: Surface,
    place: Float[np.ndarray, "2 points"],
    offset: Float[np.ndarray, "3 points"],
    tolerance: float,
    steps: float,
) -> Bool[np.ndarray, "points"]:
    """Offsets within the tolerance that do not, at the border, pull by a tenth of it outward."""
    on = np.asarray((offset**2).sum(0) <= tolerance**2)
    outward = np.where(place <= 0, -1, 0) + np.where(place >= surface.last, 1, 0)
    edge = np.flatnonzero(on & outward.any(0))
    jet = surface.at(place[:, edge])
    slopes = jet.by_row, jet.by_column
    for out, slope, other in zip(outward[:, edge], slopes, slopes[::-1], strict=True):
        share = (slope * other).sum(0) / ((other**2).sum(0) + np.finfo(other.dtype).tiny)
        across = slope - share * other
        length = np.sqrt((across**2).sum(0)) + np.finfo(other.dtype).tiny
        pull = out * (offset[:, edge] * across).sum(0) / length
        on[edge] &= pull <= tolerance / 10 + steps * length
    return on


def _check(name: str, low: float, high: float, nodes: int) -> None:
    if not 0 <= low < high <= 1:
        raise InputError(
            f"The range of {name} is two volume fractions in [0, 1], the lower first; got "
            f"({low:g}, {high:g}). Was it given in percent?"
        )
    if nodes < 2:
        raise InputError(f"A table has at least 2 nodes of {name}; got {nodes}.")


@torch.no_grad()
def _halves(
    reflectance: SkinReflectance, matrix: Float[Tensor, "wavelength 3"], mel: Axis, blood: Axis
) -> Float[np.ndarray, "mel blood 3"]:
    """Colours at the nodes and halfway between them, in float64."""
    exact = copy.deepcopy(reflectance).to("cpu", torch.float64)
    f_mel, f_blood = (
        torch.from_numpy(axis.fractions(np.arange(0, axis.nodes - 0.75, 0.5)))
        for axis in (mel, blood)
    )
    contracted = matrix.detach().to("cpu", torch.float64)
    # Some rows at a time: the spectra of the whole table take as long to allocate as to make.
    rows = [exact.bands(some[:, None], f_blood) @ contracted for some in f_mel.split(_ROWS)]
    return torch.cat(rows).numpy()
