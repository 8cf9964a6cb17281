"""The global colour transform between the skin model and recorded colours."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from jaxtyping import Float, Shaped
from scipy.spatial import cKDTree

from skinnet.calibration._checks import check_data, check_model, root_mean_square
from skinnet.calibration._distance import GamutDistance, Match
from skinnet.errors import InputError, _check_count

_MAX_COLOURS, _START_COLOURS = 20_000, 3_000
"""Recorded colours of the last fit, and of those from each start; more cost time and gain little
beside the mismatch of real skin."""

_START_SCALES = (0.4, 0.63, 1.0, 1.6, 2.5)
"""Overall scales of the starts, in units of the ratio of means: half of the gamut has a mean up to
2.5 times that of the whole."""

_ALTERNATIONS, _MAX_STEPS, _LAST_STEP = 5, 40, 1e-4
"""Alternations from each start; then most steps of a fit, and the relative step that ends it."""

_FREEDOM = 5.0
"""Degrees of freedom of Student's t, the distribution of distances: 95 % efficient where the noise
is normal."""

_SCALE_STEPS = 12
"""Steps of the likeliest scale."""

_MARGIN = 2.0
"""Standard deviations by which noise may carry colours over the boundary of the gamut."""

_SLIDES, _HOPS, _LAST_GAIN = (0.06, 0.15), 3, 3e-4
"""Changes of melanin, as shares of the rows of the grid, by which a start is moved to find the
minima beside it; the most moves, and the gain of log-likelihood below which one is the last."""

_FARTHEST = 3
"""Number of other transforms that are fitted to all colours, for the uncertainty."""

_AS_GOOD = 2.0, 0.07
"""Log-likelihood by which another minimum explains the data as well: of all colours together, and
of each colour that is not skin."""

_NOISE_LEVELS = (0.2, 1.0)
"""Levels at which noise turns from constant to proportional, as shares of the median value: 8-bit
sRGB, and a linear sensor. The likelier one is used."""

_COVERAGE = 0.1
"""Weight of the coverage beside the mean cost of a colour when a start is chosen: enough to
reject a transform that is twice too bright, which explains noisy colours of pale skin as well."""

_OUTLIER, _HIDDEN = 5.0, 0.25
"""Standard deviations beyond which a colour is not noisy skin but something else; and hidden among
the noise, such colours as a share of those beyond. The share was chosen on the people of
`benchmarks.calibration`, so that the uncertainty covers their errors without exceeding 1."""

_NEAR, _FAR = 0.03, 0.1
"""Shares of the data's length: a model colour has data near it; a fit does not describe skin."""

_SINGULAR_VALUES = (0.02, 50.0)
"""Range of the singular values, in units of the ratio of lengths; outside, it has collapsed."""


@dataclass(frozen=True)
class Calibration:
    """Colour transform: transform @ model colour ~ recorded colour.

    Attributes:
        transform: The 3 x 3 matrix.
        data_rms: Distance from the data to the transformed colours, in the data's unit.
        model_rms: Distance back, from those nodes of the model that have data near them.
        overlap: Share of the nodes that have data near them.
        uncertainty: Bound of the relative error of the transform (Frobenius norm) that holds in at
            least 90 % of the trials of `benchmarks.calibration`. Its first part is the standard
            error that colours inside the gamut give, times the root of 1 + n (e / 4)^2: n is the
            number of colours and e the share beyond five standard deviations. These are lips and
            brows rather than skin, and those of them that are hidden in the noise displace the
            residuals of all colours together. Its second part is the distance to the farthest
            transform that explains the data as well; the two are added as squares.
        iterations: Steps of the last fit.
        converged: Whether its last step was small.
    """

    transform: Float[np.ndarray, "3 3"]
    data_rms: float
    model_rms: float
    overlap: float
    uncertainty: float
    iterations: int
    converged: bool


@dataclass(frozen=True)
class _Fit:
    transform: Float[np.ndarray, "3 3"]
    match: Match
    scale: float
    iterations: int
    converged: bool

    @property
    def cost(self) -> float:
        """Mean negative log-likelihood of a colour, up to a constant."""
        return _cost(self.match, self.scale)

    @property
    def outliers(self) -> float:
        """Share of the colours inside the gamut that are not noisy skin."""
        distance = self.match.distance[self.match.inside]
        far = distance > _OUTLIER * _deviation(self.match)
        return float(far.mean()) if len(far) else 1.0


def calibrate(
    data: Float[np.ndarray, "colours channels"],
    model: Shaped[np.ndarray, "*nodes channels_of_model"],
    seed: int = 0,
) -> Calibration:
    """Fit the 3 x 3 transform between model colours and recorded colours of skin.

    Bidirectional nearest neighbours and least squares alternate from several overall scales, as in
    the paper. Each start is refined by robust least squares of the distance to the continuous
    surface, which discrete neighbours resolve too coarsely: the surface nearly slides along itself
    in the direction that looks like a change of melanin, where there are several minima. A
    fit that explains the data and has model colours near to them is moved along that direction as
    long as this helps. The last fit starts from the mean of all that explain the data as well.

    Args:
        data: Linear RGB of skin alone.
        model: Linear RGB of the model over melanin and hemoglobin [rows, columns, 3], or the same
            nodes in one list, row by row.
        seed: Seed of the subsample of the data that is used.

    Returns:
        The transform, and how well it is determined.

    Raises:
        InputError: There are too few colours, colours that are not finite, nearly one colour, or
            colours on a line; the model is not a smooth grid; or no transform brings the two near.

    Source:
        Section 4.3 of Alotaibi & Smith 2017.

    Example:
        >>> import numpy as np
        >>> mel, blood = np.meshgrid(np.linspace(0, 2, 16), np.linspace(0, 1, 16), indexing="ij")
        >>> depth = mel[..., None] * [0.4, 0.7, 1.0] + blood[..., None] * [0.1, 0.6, 0.4]
        >>> model = 0.1 + 0.7 * np.exp(-depth)
        >>> found = calibrate(0.8 * model.reshape(-1, 3), model)
        >>> np.diag(found.transform).round(2).tolist()
        [0.8, 0.8, 0.8]
    """
    grid, data = check_model(model), check_data(data)
    _check_count("seed", seed)
    colours = np.random.default_rng(seed).permutation(data)[:_MAX_COLOURS]
    transform, level, others = _choose_start(grid, colours[:_START_COLOURS])
    distance = GamutDistance(colours, grid, level)
    fit = _fit(distance, transform)
    # The farthest of them; more colours may bring them together.
    others = sorted(others, key=lambda one: -float(np.linalg.norm(one - fit.transform)))
    others = [_descend(distance, one).transform for one in others[:_FARTHEST]]
    return _describe(grid.reshape(-1, 3), colours, fit, others)


def _choose_start(
    grid: Float[np.ndarray, "rows columns 3"], colours: Float[np.ndarray, "some 3"]
) -> tuple[Float[np.ndarray, "3 3"], float, list[Float[np.ndarray, "3 3"]]]:
    """Choose transform and noise level that explain the colours and cover the model.

    The third result is all transforms that do so as well under their noise level. The first is
    their mean, as no one of them is likelier to be the true one.
    """
    nodes = grid.reshape(-1, 3)
    ratio = np.diag(colours.mean(0) / nodes.mean(0))
    starts = [_alternate(colours, nodes, scale * ratio) for scale in _START_SCALES]
    slides = _tabulate_slides(grid)
    tries = [
        sorted(_search(GamutDistance(colours, grid, level), starts, slides), key=_cost_of)
        for level in _NOISE_LEVELS
    ]
    likelier = int(np.argmin([of_level[0].cost for of_level in tries]))
    tolerance = _AS_GOOD[0] / len(colours) + _AS_GOOD[1] * tries[likelier][0].outliers
    good = [
        ((one.cost - of_level[0].cost) / tolerance, one.transform)
        for of_level in tries
        for one in of_level
        if one.cost < of_level[0].cost + tolerance
    ]
    others = [transform for _, transform in good]
    weights = np.exp([-2 * excess for excess, _ in good])
    return np.average(others, axis=0, weights=weights), _NOISE_LEVELS[likelier], others


class _Try(NamedTuple):
    cost: float
    transform: Float[np.ndarray, "3 3"]
    outliers: float


def _cost_of(one: _Try) -> float:
    return one.cost


def _search(
    distance: GamutDistance,
    starts: list[Float[np.ndarray, "3 3"]],
    slides: list[Float[np.ndarray, "3 3"]],
) -> list[_Try]:
    """Fit from each start, then from the neighbours of the best as long as one is better."""

    def attempt(start: Float[np.ndarray, "3 3"]) -> _Try:
        fit = _descend(distance, start)
        coverage = _COVERAGE * distance.measure_coverage(fit.transform)
        return _Try(fit.cost + distance.log_scale + coverage, fit.transform, fit.outliers)

    tries = [attempt(start) for start in starts]
    for _ in range(_HOPS):
        best = min(tries, key=_cost_of)
        tries += [attempt(best.transform @ slide) for slide in slides]
        if min(tries, key=_cost_of).cost > best.cost - _LAST_GAIN:
            break
    return tries


def _tabulate_slides(grid: Float[np.ndarray, "rows columns 3"]) -> list[Float[np.ndarray, "3 3"]]:
    """Transforms that bring the model's colours near to those with more or less melanin."""
    slides = []
    for rows in (max(1, round(share * len(grid))) for share in _SLIDES):
        pair = grid[rows:].reshape(-1, 3), grid[:-rows].reshape(-1, 3)
        for source, target in (pair, pair[::-1]):
            weight = 1 / (np.linalg.norm(target, axis=1, keepdims=True) + 1e-12)
            slides.append(np.linalg.lstsq(source * weight, target * weight)[0].T)
    return slides


def _alternate(
    data: Float[np.ndarray, "colours 3"],
    model: Float[np.ndarray, "nodes 3"],
    transform: Float[np.ndarray, "3 3"],
) -> Float[np.ndarray, "3 3"]:
    """Alternate nearest neighbours in both directions with least squares.

    Every recorded colour is matched to the nearest model colour, which keeps the transform from
    growing. Every model colour that is a match is matched to the nearest recorded colour, which
    keeps the transform from shrinking to a point.
    """
    tree = cKDTree(data)
    for _ in range(_ALTERNATIONS):
        moved = model @ transform.T
        to_model = np.asarray(cKDTree(moved).query(data)[1])
        to_data = np.asarray(tree.query(moved)[1])
        matched = np.unique(to_model)
        # Both directions weigh the same, whatever their numbers of colours.
        weights = len(to_model) ** -0.5, len(matched) ** -0.5
        source = np.concatenate([model[to_model] * weights[0], model[matched] * weights[1]])
        target = np.concatenate([data * weights[0], data[to_data[matched]] * weights[1]])
        transform = np.linalg.lstsq(source, target)[0].T
    return transform


def _fit(distance: GamutDistance, transform: Float[np.ndarray, "3 3"]) -> _Fit:
    """Fit without a margin at the boundary, then with that of the noise which this leaves."""
    first = _descend(distance, transform)
    return _descend(distance, first.transform, _MARGIN * _deviation(first.match))


def _descend(
    distance: GamutDistance, transform: Float[np.ndarray, "3 3"], margin: float = 0.0
) -> _Fit:
    """Maximise the likelihood of transform and scale by reweighted Levenberg-Marquardt steps."""
    match, damping, relative_step = distance.match(transform, margin), 1e-3, float("inf")
    scale, iterations = _scale(match), 0
    while iterations < _MAX_STEPS and relative_step > _LAST_STEP:
        weights = 1 / (1 + (match.distance / scale) ** 2)
        weighted = match.derivatives.T * weights
        hessian, gradient = weighted @ match.derivatives, weighted @ match.distance
        cost = _cost(match, scale)
        while damping < 1e6:
            damped = hessian + damping * np.diag(np.diag(hessian))
            step = -(_invert(damped) @ gradient).reshape(3, 3)
            after = distance.match(transform + step, margin)
            if _cost(after, scale) <= cost:
                break
            damping *= 8
        else:
            break
        transform, match, damping = transform + step, after, damping / 5
        scale, iterations = _scale(match), iterations + 1
        relative_step = float(np.linalg.norm(step) / np.linalg.norm(transform))
    # Steps that no damping makes useful end at a minimum as well.
    return _Fit(transform, match, scale, iterations, iterations < _MAX_STEPS)


def _cost(match: Match, scale: float) -> float:
    tail = np.log1p((match.distance / scale) ** 2).mean()
    return float((_FREEDOM + 1) / 2 * tail + np.log(scale))


def _scale(match: Match) -> float:
    """Likeliest scale, that of Student's t times the root of its degrees of freedom.

    It is a minimum of the same cost as the transform. With the median's scale, steps of the
    transform could increase the cost, and minima were told apart by their medians.
    """
    square = match.distance**2
    scale = _FREEDOM * _deviation(match) ** 2
    for _ in range(_SCALE_STEPS):
        scale = (_FREEDOM + 1) * float(np.mean(square / (1 + square / scale))) + 1e-18
    return float(scale**0.5)


def _deviation(match: Match) -> float:
    """Standard deviation of normal noise with the median of the distances."""
    return 1.4826 * float(np.median(match.distance)) + 1e-9


def _invert(information: Float[np.ndarray, "9 9"]) -> Float[np.ndarray, "9 9"]:
    # Channels differ by orders of magnitude: the inverse is that of the correlations.
    scale = np.sqrt(np.diag(information)) + np.finfo(np.float64).tiny ** 0.5
    correlation = information / np.outer(scale, scale)
    return np.asarray(np.linalg.pinv(correlation, 1e-14, True) / np.outer(scale, scale))


def _estimate_uncertainty(fit: _Fit, others: list[Float[np.ndarray, "3 3"]]) -> float:
    """Relative bound of the transform's error; `Calibration` says how it is made."""
    inside, deviation = fit.match.inside, _deviation(fit.match)
    distance, normals = fit.match.distance[inside], fit.match.normals[inside]
    weights = 1 / (1 + (distance / fit.scale) ** 2) / deviation**2
    variance = np.trace(_invert((normals.T * weights) @ normals))
    inflation = 1 + fit.match.inside.size * (_HIDDEN * fit.outliers) ** 2
    spread = max(float(np.linalg.norm(other - fit.transform)) for other in others)
    return float(np.sqrt(variance * inflation + spread**2) / np.linalg.norm(fit.transform))


def _describe(
    nodes: Float[np.ndarray, "nodes 3"],
    colours: Float[np.ndarray, "colours 3"],
    fit: _Fit,
    others: list[Float[np.ndarray, "3 3"]],
) -> Calibration:
    moved, length = nodes @ fit.transform.T, root_mean_square(colours)
    data_rms = root_mean_square(colours - (fit.transform @ fit.match.model).T)
    singular = np.linalg.svd(fit.transform, compute_uv=False) * root_mean_square(nodes) / length
    # A transform that mirrors channels or flattens them shows that no other came near.
    collapsed = singular[-1] < _SINGULAR_VALUES[0] or singular[0] > _SINGULAR_VALUES[1]
    if data_rms > _FAR * length or collapsed or np.linalg.det(fit.transform) <= 0:
        raise InputError(
            f"No transform brings these colours near those of skin: they stay {data_rms:.2g} away, "
            f"at singular values {singular.round(3).tolist()}. Take colours of skin, of more kinds "
            "or with less noise, or name the right light and camera."
        )
    to_data = np.asarray(cKDTree(colours).query(moved)[0])
    near = to_data < _NEAR * length
    model_rms = float(np.sqrt(np.mean(to_data[near] ** 2))) if near.any() else float("inf")
    return Calibration(
        fit.transform,
        data_rms,
        model_rms,
        float(near.mean()),
        _estimate_uncertainty(fit, others),
        fit.iterations,
        fit.converged,
    )
