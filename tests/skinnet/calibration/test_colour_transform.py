"""The global colour transform from colours alone."""

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from skinnet.appearance.colour import SkinColour
from skinnet.calibration.colour_transform import calibrate
from skinnet.errors import InputError

MIX = np.array([[0.8, 0.05, 0.01], [0.03, 0.86, 0.04], [0.01, 0.06, 0.92]])
BRIGHT = np.array([[1.6, -0.05, 0.03], [0.02, 1.3, -0.04], [-0.005, 0.01, 1.1]])
COVERS = {
    "all": ((0, 1), (0, 1)),
    "paler": ((0, 0.5), (0, 1)),
    "darker": ((0.5, 1), (0, 1)),
    "less blood": ((0, 1), (0, 0.5)),
    "more blood": ((0, 1), (0.5, 1)),
}
"""Ranges of melanin and of blood, as shares of the sheet's rows and columns."""


@pytest.fixture(scope="module")
def model() -> np.ndarray:
    """Colours of skin over the whole range, a grid."""
    colour = SkinColour(nodes=(64, 64))
    table = colour.table[0].movedim(0, -1).double().numpy()
    mel, blood = (colour.lookup.fractions(axis).numpy() for axis in (0, 1))
    return table[np.ix_((mel > 0.005) & (mel < 0.43), (blood > 0.005) & (blood < 0.15))]


def noisy(
    model: np.ndarray,
    transform: np.ndarray,
    cover: str = "all",
    count: int = 20_000,
    noise: float = 0.005,
    seed: int = 0,
) -> np.ndarray:
    """Colours anywhere on a part of the sheet, at nodes or not, with noise in proportion."""
    draw = np.random.default_rng(seed)
    rows, columns = (
        np.linspace(low * (size - 1), high * (size - 1), 300)
        for (low, high), size in zip(COVERS[cover], model.shape, strict=False)
    )
    fine = CubicSpline(np.arange(len(model)), model)(rows)
    fine = CubicSpline(np.arange(model.shape[1]), fine, axis=1)(columns)
    colours = draw.choice(fine.reshape(-1, 3), count) @ transform.T
    return colours * (1 + noise * draw.normal(size=colours.shape))


def error(found: np.ndarray, known: np.ndarray) -> float:
    return float(np.linalg.norm(found - known) / np.linalg.norm(known))


@pytest.mark.parametrize(
    ("cover", "transform", "seed"),
    [
        ("all", MIX, 0),
        ("paler", MIX, 1),
        ("darker", BRIGHT, 2),
        ("less blood", BRIGHT, 3),
        ("more blood", MIX, 4),
    ],
)
def test_a_transform_comes_back_from_half_of_all_skin(
    model: np.ndarray, cover: str, transform: np.ndarray, seed: int
) -> None:
    found = calibrate(noisy(model, transform, cover, noise=0.002, seed=seed), model)
    assert error(found.transform, transform) < 0.01
    assert found.uncertainty < 0.01
    assert found.converged and found.edges > 5


def test_stray_colours_do_not_matter(model: np.ndarray) -> None:
    data = noisy(model, MIX)
    data[:400] = np.random.default_rng(1).uniform(0.05, 0.6, (400, 3))
    assert error(calibrate(data, model).transform, MIX) < 0.01


def test_noise_may_be_the_same_for_all_colours(model: np.ndarray) -> None:
    data = noisy(model, MIX, noise=0) + 0.002 * np.random.default_rng(1).normal(size=(20_000, 3))
    assert error(calibrate(data, model).transform, MIX) < 0.02


def test_data_that_fade_out_inside_the_sheet_are_no_edges(model: np.ndarray) -> None:
    draw = np.random.default_rng(0)
    inside = 0.5 + 0.13 * draw.normal(size=(2, 20_000)).clip(-3, 3)
    rows, columns = (inside * (np.array(model.shape[:2])[:, None] - 1)).round().astype(int)
    data = model[rows, columns] @ MIX.T * (1 + 0.001 * draw.normal(size=(20_000, 3)))
    found = calibrate(data, model)
    assert error(found.transform, MIX) < max(3 * found.uncertainty, 0.01)


def test_a_list_of_the_nodes_is_the_grid(model: np.ndarray) -> None:
    data = noisy(model, MIX, count=3000)
    listed = calibrate(data, model.reshape(-1, 3), 3)
    np.testing.assert_array_equal(listed.transform, calibrate(data, model, 3).transform)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda data: data[:50], "There are 50 data colours"),
        (lambda data: np.where(np.arange(len(data))[:, None] == 3, np.nan, data), "not finite"),
        (lambda data: np.tile(data[:1], (500, 1)), "all nearly one colour"),
        (lambda data: np.linspace(0.2, 1, 500)[:, None] * data[:1], "lie on a line"),
        (lambda data: -data, "skin reflects in all channels"),
        (lambda data: np.random.default_rng(0).uniform(0, 1, (2000, 3)), "No transform brings"),
        (lambda data: data[:, :2], "The data are colours"),
    ],
)
def test_degenerate_colours_are_refused(model: np.ndarray, change, words: str) -> None:
    with pytest.raises(InputError, match=words):
        calibrate(change(noisy(model, MIX)), model)


def test_a_model_that_is_no_sheet_is_refused(model: np.ndarray) -> None:
    data, nodes = noisy(model, MIX), model.reshape(-1, 3)
    for one in (np.random.default_rng(0).permutation(nodes), model[:3], nodes[:, :2]):
        with pytest.raises(InputError, match="The model"):
            calibrate(data, one)
