"""The estimate is the posterior of its model, and tells light from pigments where it can."""

import numpy as np

from skinnet.inference._comparison import estimate as module
from skinnet.inference._comparison.cells import Cells
from skinnet.inference._comparison.estimate import Reading, estimate_changes

SIDE = 12
J = np.array([[0.3, 0.25], [-0.4, 0.08]])
NOTHING = Reading(np.zeros(2), np.full(2, 0.4))


def make_cells(
    change: np.ndarray, light: np.ndarray, others: int = 40, seed: int = 0
) -> tuple[Cells, np.ndarray]:
    """Cells of skin [SIDE^2] with a change each, and others, in another light; and J of each."""
    rng = np.random.default_rng(seed)
    rows, columns = np.divmod(np.arange(SIDE**2 + others), SIDE)
    skin = np.arange(len(rows)) < SIDE**2
    first = np.log(rng.uniform(0.2, 0.5, (len(rows), 3)))
    first[skin] = np.log([0.5, 0.3, 0.2]) + 0.02 * rng.standard_normal((skin.sum(), 3))
    shift = np.zeros((len(rows), 3))
    shift[:, ::2] = light
    shift[skin, ::2] += change @ J.T
    cells = Cells(
        np.stack([rows, columns], -1),
        SIDE + others,
        np.zeros(2),
        1.0,
        np.stack([columns, rows], -1) / SIDE - 0.5,
        np.stack([first, first + shift], 1),
        np.zeros(len(rows)),
        np.log(np.full((len(rows), 2, 2), 0.05)),
        np.full(len(rows), 0.05),
        skin,
        ~skin,
    )
    return cells, np.broadcast_to(J, (skin.sum(), 2, 2))


def test_a_change_of_light_is_no_change_of_skin() -> None:
    light = np.array([0.15, -0.2])
    found = estimate_changes(*make_cells(np.zeros((SIDE**2, 2)), light), NOTHING)
    np.testing.assert_allclose(found.light, light, atol=0.02)
    np.testing.assert_allclose(found.change, 0, atol=0.05)
    assert found.other_cells and not found.conflict


def test_what_is_not_skin_tells_a_uniform_change_from_light() -> None:
    change, light = np.array([0.4, -0.3]), np.array([0.1, -0.1])
    cells, derivatives = make_cells(np.tile(change, (SIDE**2, 1)), light)
    everything = np.ones(SIDE**2, bool)
    unsure = Reading(np.zeros(2), np.full(2, 0.6))
    mean, covariance = estimate_changes(cells, derivatives, unsure).average(everything)
    np.testing.assert_allclose(mean, change, atol=0.15)
    alone = estimate_changes(cells._replace(matches=~cells.skin & False), derivatives, unsure)
    blind, wide = alone.average(everything)
    np.testing.assert_allclose(blind, 0, atol=0.02)  # what the network reads, and no more
    assert (np.diag(covariance) < 0.6 * np.diag(wide)).all()


def test_a_local_change_is_found_without_anything_else() -> None:
    place = make_cells(np.zeros((SIDE**2, 2)), np.zeros(2))[0].place[: SIDE**2]
    cheek = np.hypot(*(place - (0.2, 0.1)).T) < 0.15
    change = np.where(cheek[:, None], (0.0, 0.6), 0.0)
    cells, derivatives = make_cells(change, np.array([0.1, -0.2]), others=0)
    found = estimate_changes(cells, derivatives, NOTHING)
    mean, covariance = found.contrast(cheek)
    sds = np.sqrt(np.diag(covariance))
    # The prior expects small local changes, and a map shows too little rather than too much.
    assert 0.25 < mean[1] < 0.65 and mean[1] > 1.645 * sds[1]
    assert abs(mean[0]) < 1.645 * sds[0]
    assert (sds < 0.6 * np.sqrt(np.diag(found.average(cheek)[1]))).all()


def test_local_changes_leave_the_change_of_the_face_to_what_is_read() -> None:
    rng = np.random.default_rng(3)
    change = 0.3 * rng.standard_normal((SIDE**2, 2))
    cells, derivatives = make_cells(change, np.array([0.3, 0.2]), others=0)
    mean, _ = estimate_changes(cells, derivatives, NOTHING).average(np.ones(SIDE**2, bool))
    np.testing.assert_allclose(mean, 0, atol=0.02)


def test_other_clothes_are_left_out() -> None:
    cells, derivatives = make_cells(np.zeros((SIDE**2, 2)), np.zeros(2))
    colour = cells.colour.copy()
    colour[~cells.skin, 1] += (0.8, 0, -0.8)
    found = estimate_changes(cells._replace(colour=colour), derivatives, NOTHING)
    assert found.conflict and not found.other_cells
    np.testing.assert_allclose(found.change, 0, atol=0.05)


def test_mean_and_covariance_are_those_of_the_whole_gaussian() -> None:
    """Condition all unknowns at once, with common parameters and local changes in one vector."""
    rng = np.random.default_rng(1)
    noise = np.zeros((SIDE**2, 2)) + 0.01 * rng.standard_normal((SIDE**2, 2))
    cells, derivatives = make_cells(noise, np.array([0.02, 0.01]), others=0)
    found = estimate_changes(cells, derivatives, NOTHING)
    system, kernel = found.solution.system, found.solution.kernel
    count, common = SIDE**2, len(system.prior)
    local = np.kron(kernel, np.diag(module._LOCAL**2))
    prior = np.block(
        [
            [system.prior, np.zeros((common, 2 * count))],
            [np.zeros((2 * count, common)), local],
        ]
    )
    blocks = np.zeros((2 * count, 2 * count))
    for number in range(count):
        at = slice(2 * number, 2 * number + 2)
        blocks[at, at] = derivatives[number]
    design = np.concatenate([system.design, blocks], 1)
    spread = module._share_noise(system) + np.diag(np.repeat(system.variance, 2))
    gain = prior @ design.T @ np.linalg.inv(design @ prior @ design.T + spread)
    start = np.concatenate([system.prior_mean, np.zeros(2 * count)])
    mean = start + gain @ (system.difference - design @ start)
    covariance = prior - gain @ design @ prior
    chosen = np.arange(count) < 30
    select = np.zeros((2, common + 2 * count))
    select[:, :2] = np.eye(2)
    select[:, common:] = np.kron(chosen / chosen.sum(), np.eye(2))
    average = found.average(chosen)
    np.testing.assert_allclose(average[0], select @ mean, atol=1e-6)
    np.testing.assert_allclose(average[1], select @ covariance @ select.T, atol=1e-6)
