"""The change of light and of pigments that two photographs of a face tell together.

Light, camera and processing change the chroma (log R/G, log B/G) of everything in a photograph by
about the same amount; pigments change that of skin alone, in directions that are known. With u the
difference of chroma in a cell,

    skin:      u = J_k (c + l_k) + d + A x_k + b y_k + G p_k + noise
    not skin:  u = d + g + A x_k + b y_k + noise

J_k holds the derivatives of chroma by log pigments, c is the change of the whole face, l_k a local
change around it (a Gaussian process over the face, whose mean there is 0), d the change of light at
the skin's own colour; A, b and G let it depend on chroma x, luminance y and place p, as tone
curves, saturation and mixed light do. g is how far what is not skin follows another change than
skin.

Skin alone cannot tell c from d. What the network reads in each photograph is the prior of c: it has
seen the colour of the skin, so that d has no other prior. All else is a Gaussian linear model with
robust weights, whose posterior is exact. c is found with the mean of J_k over the face: how strong
a pattern is depends on tone curves more than on pigments.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import cho_factor, cho_solve

from skinnet.inference._comparison.cells import Cells
from skinnet.inference._comparison.colour_derivatives import compute_chroma

_NETWORK = np.array([1.0, 0.8])
"""Factors on the network's standard deviations of both pigments: pairs of synthetic faces, whose
errors are partly shared, have this much."""

_CORRELATION = -0.3
"""Correlation of the errors of both pigments' changes in pairs of synthetic faces."""

_USUAL_CHANGE = 0.5
"""Standard deviation of the log change of a pigment before anything is seen."""

_LIGHT, _CHROMA, _LUMINANCE, _PLACE = 5.0, 0.1, 0.05, 0.05
"""Prior standard deviations of d, and of the entries of A, b and G."""

_OWN_WAY, _SCATTER = 0.04, 4.0
"""Prior standard deviation of g: at least the first, and the second times the scatter of u in what
is not skin, which shows how simple the change of light is."""

_LOCAL, _LARGEST_FACTOR = np.array([0.12, 0.25]), 8.0
"""Standard deviations of local log changes of both pigments, and the largest factor on them where
the chroma of neighbouring cells has changed by more."""

_FAR, _NEAR = 0.25, 0.08
"""Lengths of the two scales of local changes, in lengths of the face."""

_NOISE, _SPREAD, _DARK = 0.02, 0.3, 0.004
"""Noise of u: at least the first, the second times the spread within a cell, and the third over the
linear value of the darkest channel."""

_SHARED, _SHARED_FAR, _SHARED_OTHER = 0.06, 0.25, 0.1
"""Noise that neighbours share: of skin, its length in lengths of the face, and of other things."""

_DEGREES, _ROUNDS = 4.0, 3
"""Degrees of freedom of Student's t, to which robust weights belong, and rounds of weighting."""

_MOST_OTHER = 120
"""Largest number of cells that are not skin, which keeps the time short."""

_IMPLAUSIBLE = 9.2
"""Squared distance (1 % of chi-squared with two degrees of freedom) from what the network reads at
which what is not skin is taken for other things than before."""

Array = NDArray[np.float64]


class Reading(NamedTuple):
    """What the network reads of the change of the face: log change [2] and standard deviations."""

    change: Array
    sds: Array


class Estimate(NamedTuple):
    """The posterior of the log change of both pigments.

    Attributes:
        change: Log change of each skin cell, [skin cells, 2].
        light: Change of log R/G and log B/G of the light at the skin's colour, [2].
        other_cells: Number of cells that are not skin and were used.
        conflict: Whether what is not skin contradicts the reading, and was left out.
        solution: What the average over some cells is computed from.
    """

    change: Array
    light: Array
    other_cells: int
    conflict: bool
    solution: "_Solution"

    def average(self, chosen: NDArray[np.bool_]) -> tuple[Array, Array]:
        """The mean log change [2] over some skin cells, and its covariance [2, 2]."""
        return self.solution.sum(chosen / chosen.sum())

    def contrast(self, chosen: NDArray[np.bool_]) -> tuple[Array, Array]:
        """The same of the difference between some skin cells and all others."""
        return self.solution.sum(chosen / chosen.sum() - ~chosen / max((~chosen).sum(), 1))


class _System(NamedTuple):
    """The linear model of the cells: skin first, then others."""

    skin: int
    difference: Array
    design: Array
    own_design: Array
    derivatives: Array
    place: Array
    variance: Array
    prior_mean: Array
    prior: Array


class _Solution(NamedTuple):
    """A solved system: posterior of the common parameters, and what local changes need."""

    system: _System
    kernel: Array
    cross: Array
    solved_design: Array
    solved_rest: Array
    factor: tuple[Array, bool]
    mean: Array
    covariance: Array

    def sum(self, weights: Array) -> tuple[Array, Array]:
        """Mean and covariance of a weighted sum of c + l over the skin cells."""
        cross = np.einsum("i,ipn->pn", weights, self.cross)
        share = weights.sum()
        gain = share * np.eye(2, len(self.mean)) - cross @ self.solved_design
        mean = share * self.mean[:2] + cross @ self.solved_rest
        own = np.diag(_LOCAL**2) * (weights @ self.kernel @ weights)
        rest = own - cross @ cho_solve(self.factor, cross.T)
        return mean, gain @ self.covariance @ gain.T + rest

    def change(self) -> Array:
        """Mean of c + l of each skin cell."""
        local: Array = self.cross @ self.solved_rest
        return self.mean[:2] + local


def estimate_changes(cells: Cells, derivatives: Array, reading: Reading) -> Estimate:
    """Estimate the change of light and of pigments together.

    Args:
        cells: Cells of both photographs; some are skin.
        derivatives: Of chroma by log pigments, of the skin cells, [skin cells, chroma, pigment].
        reading: What the network reads in each of the photographs.

    Returns:
        The posterior of the changes.
    """
    others = _choose_others(cells)
    solution = _solve(_build(cells, others, derivatives, reading))
    conflict = bool(len(others)) and _contradicts(solution, cells, derivatives, reading)
    if conflict:
        others = others[:0]
        solution = _solve(_build(cells, others, derivatives, reading))
    return Estimate(solution.change(), solution.mean[2:4], len(others), conflict, solution)


def _contradicts(solution: _Solution, cells: Cells, derivatives: Array, reading: Reading) -> bool:
    """Whether what is not skin moves the change further than its uncertainty allows."""
    alone = _build(cells, np.empty(0, np.intp), derivatives, reading)
    moved = solution.mean[:2] - alone.prior_mean[:2]
    spread = alone.prior[:2, :2] - solution.covariance[:2, :2] + 1e-4 * np.eye(2)
    return float(moved @ np.linalg.solve(spread, moved)) > _IMPLAUSIBLE


def _choose_others(cells: Cells) -> NDArray[np.intp]:
    """Cells that are not skin, and show the same structure in both photographs."""
    found = np.flatnonzero(cells.matches)
    return found[:: 1 + len(found) // _MOST_OTHER]


def _build(cells: Cells, others: NDArray[np.intp], derivatives: Array, reading: Reading) -> _System:
    inside = np.flatnonzero(cells.skin)
    chosen, count = np.concatenate([inside, others]), len(inside)
    colour, place = cells.colour[chosen], cells.place[chosen]
    chroma = compute_chroma(colour)
    difference = chroma[:, 1] - chroma[:, 0]
    x, y = chroma.mean(1), colour[..., 1].mean(1)
    own = _design(x - x[:count].mean(0), y - y[:count].mean(), place, derivatives)
    design = own.copy()
    design[:count, :, :2] = derivatives.mean(0)
    dark = _DARK / np.exp(colour).min((1, 2))
    variance = _NOISE**2 + (_SPREAD * cells.spread[chosen]) ** 2 + dark**2
    mean, prior = _make_prior(reading, difference[count:], design.shape[-1])
    rows = 2 * len(chosen)
    return _System(
        count,
        difference.reshape(rows),
        design.reshape(rows, -1),
        own.reshape(rows, -1),
        derivatives,
        place,
        variance,
        mean,
        prior,
    )


def _design(x: Array, y: Array, place: Array, derivatives: Array) -> Array:
    """Columns for c, d, A, b, G and g: [cells, chroma, 16]."""
    count, skin = len(x), np.arange(len(x)) < len(derivatives)
    own = np.zeros((count, 2, 2))
    own[skin] = derivatives
    ones = np.ones((count, 1))
    parts = (ones, x, y[:, None], place * skin[:, None], ones * ~skin[:, None])
    columns = [np.einsum("ik,ab->iabk", part, np.eye(2)).reshape(count, 2, -1) for part in parts]
    return np.concatenate([own, *columns], -1)


def _make_prior(reading: Reading, others: Array, size: int) -> tuple[Array, Array]:
    """Mean and covariance of the common parameters."""
    sds = _NETWORK * reading.sds
    read = np.linalg.inv(np.outer(sds, sds) * np.array([[1, _CORRELATION], [_CORRELATION, 1]]))
    covariance = np.linalg.inv(read + np.eye(2) / _USUAL_CHANGE**2)
    mean = np.zeros(size)
    mean[:2] = covariance @ read @ reading.change
    sizes = (_LIGHT, 2), (_CHROMA, 4), (_LUMINANCE, 2), (_PLACE, 4), (_find_own_way(others), 2)
    prior = np.diag(np.concatenate([[0, 0], *(np.full(n, sd**2) for sd, n in sizes)]))
    prior[:2, :2] = covariance
    return mean, prior


def _find_own_way(others: Array) -> float:
    if not len(others):
        return 1.0
    scatter = 1.48 * float(np.median(np.abs(others - np.median(others, 0)), 0).max())
    return float(np.hypot(_OWN_WAY, _SCATTER * scatter))


def _solve(system: _System) -> _Solution:
    count = system.skin
    kernel = _correlate(system.place, _FAR) / 2 + _correlate(system.place, _NEAR) / 2
    kernel = kernel[:count, :count]
    precision, noise = np.linalg.inv(system.prior), _share_noise(system)
    weight, scale = np.ones(len(system.variance)), np.ones(count)
    for _ in range(_ROUNDS):
        scaled = _centre(kernel * np.outer(scale, scale))
        whole = noise + _spread_local(system, scaled)
        total = system.variance + np.diag(whole).reshape(-1, 2).mean(-1)
        whole += np.diag(np.repeat(system.variance / weight, 2))
        factor = cho_factor(whole, lower=True)
        solved = cho_solve(factor, system.design)
        covariance = np.linalg.inv(system.design.T @ solved + precision)
        mean = covariance @ (solved.T @ system.difference + precision @ system.prior_mean)
        rest = (system.difference - system.design @ mean).reshape(-1, 2)
        weight[count:] = np.minimum(_weigh(rest[count:], total[count:]), 1)
        scale = _find_scale(rest[:count], total[:count], system.place[:count], scale)
    return _Solution(
        system,
        scaled,
        _cross(system, scaled),
        cho_solve(factor, system.own_design),
        cho_solve(factor, system.difference - system.own_design @ mean),
        factor,
        mean,
        covariance,
    )


def _weigh(rest: Array, variance: Array) -> Array:
    """Robust weights of residuals [N, 2], at most 1 for what is as expected."""
    weight: Array = (_DEGREES + 2) / (_DEGREES + (rest**2).sum(-1) / variance)
    return weight


def _find_scale(rest: Array, variance: Array, place: Array, scale: Array) -> Array:
    """Factors of local changes: larger where neighbours together leave more than expected."""
    near = _correlate(place, _NEAR)
    smooth = near @ rest / near.sum(-1, keepdims=True)
    found: Array = np.maximum(_weigh(smooth, variance), 1e-3) ** -0.5
    return np.clip(scale * found, 1.0, _LARGEST_FACTOR)


def _cross(system: _System, kernel: Array) -> Array:
    """Covariance of local changes with all differences, [skin cells, pigment, rows]."""
    count = system.skin
    padded = np.zeros((count, 2, len(system.difference)))
    cross = np.einsum("p,ij,jap->ipja", _LOCAL**2, kernel, system.derivatives)
    padded[..., : 2 * count] = cross.reshape(count, 2, -1)
    return padded


def _share_noise(system: _System) -> Array:
    skin = np.arange(len(system.place)) < system.skin
    sds = np.where(skin, _SHARED, _SHARED_OTHER)
    alike = skin[:, None] == skin[None]
    near = np.where(alike, np.outer(sds, sds) * _correlate(system.place, _SHARED_FAR), 0)
    return np.asarray(np.kron(near, np.eye(2)), np.float64)


def _spread_local(system: _System, kernel: Array) -> Array:
    """Covariance of the differences that local changes of the pigments make."""
    count, rows = system.skin, len(system.difference)
    jacobian = system.derivatives
    colours = np.einsum("iap,p,jbp->iajb", jacobian, _LOCAL**2, jacobian, optimize=True)
    whole = np.zeros((rows, rows))
    whole[: 2 * count, : 2 * count] = (kernel[:, None, :, None] * colours).reshape(2 * count, -1)
    return whole


def _centre(kernel: Array) -> Array:
    """Covariance of local changes less their mean over the face, which is that of the face."""
    return np.asarray(kernel - kernel.mean(0) - kernel.mean(1, keepdims=True) + kernel.mean())


def _correlate(place: Array, length: float) -> Array:
    squares = ((place[:, None] - place[None]) ** 2).sum(-1)
    correlation: Array = np.exp(-squares / (2 * length**2))
    return correlation
