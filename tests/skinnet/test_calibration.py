"""The global colour transform from colours alone."""

import numpy as np
import pytest

from skinnet.appearance.colour import SkinColour
from skinnet.calibration import calibrate
from skinnet.errors import InputError

MIX = np.array([[0.8, 0.05, 0.01], [0.03, 0.86, 0.04], [0.01, 0.06, 0.92]])


@pytest.fixture(scope="module")
def model() -> np.ndarray:
    """Colours of skin over the whole range."""
    colour = SkinColour(nodes=(64, 64))
    table = colour.table[0].movedim(0, -1).double().numpy()
    mel, blood = (colour.lookup.fractions(axis).numpy() for axis in (0, 1))
    inside = np.ix_((mel > 0.005) & (mel < 0.43), (blood > 0.005) & (blood < 0.15))
    return table[inside].reshape(-1, 3)


def noisy(model: np.ndarray, transform: np.ndarray) -> np.ndarray:
    draw = np.random.default_rng(0)
    colours = draw.choice(model, 5000) @ transform.T
    return colours * (1 + 0.01 * draw.normal(size=colours.shape))


def test_a_transform_comes_back_from_a_sample_of_all_skin(model: np.ndarray) -> None:
    found = calibrate(noisy(model, MIX), model)
    assert np.linalg.norm(found.transform - MIX) / np.linalg.norm(MIX) < 0.1
    assert found.data_rms < 0.02 and found.overlap > 0.9


def test_the_same_seed_gives_the_same_transform(model: np.ndarray) -> None:
    data = noisy(model, MIX)
    first, second = (calibrate(data, model, 3).transform for _ in range(2))
    np.testing.assert_array_equal(first, second)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda data: data[:50], "There are 50 data colours"),
        (lambda data: np.where(np.arange(len(data))[:, None] == 3, np.nan, data), "not finite"),
        (lambda data: np.tile(data[:1], (500, 1)), "all nearly one colour"),
        (lambda data: np.linspace(0.2, 1, 500)[:, None] * data[:1], "lie on a line"),
    ],
)
def test_degenerate_colours_are_refused(model: np.ndarray, change, words: str) -> None:
    with pytest.raises(InputError, match=words):
        calibrate(change(noisy(model, MIX)), model)
