"""The nearest colour is the one that an exhaustive search finds."""

import numpy as np
import pytest
import torch
from jaxtyping import Float, Int
from scipy.spatial import cKDTree

from skinnet.physics import nearest_colour
from skinnet.physics.nearest_colour import NearestColour
from skinnet.physics.reflectance import SkinReflectance
from skinnet.physics.sources import load_spectrum_to_srgb


def skin(rows: int, columns: int) -> Float[np.ndarray, "rows columns 3"]:
    f_mel = 0.43 * torch.linspace(0, 1, rows).double()[:, None] ** 2
    f_blood = 0.15 * torch.linspace(0, 1, columns).double() ** 2
    reflectance = SkinReflectance(dtype=torch.float64)
    return (reflectance(f_mel, f_blood) @ load_spectrum_to_srgb("D65", "Nikon D200")).numpy()


def brute_force(
    table: Float[np.ndarray, "rows columns 3"], colours: Float[np.ndarray, "n 3"]
) -> Int[np.ndarray, "n"]:
    nodes = table.reshape(-1, 3)
    parts = np.array_split(colours.astype(np.float64), len(colours) // 200 + 1)
    return np.concatenate([((q[:, None] - nodes) ** 2).sum(-1).argmin(1) for q in parts])


def distance(
    table: Float[np.ndarray, "rows columns 3"],
    colours: Float[np.ndarray, "n 3"],
    index: Int[np.ndarray, "n"],
) -> Float[np.ndarray, "n"]:
    return np.linalg.norm(colours - table.reshape(-1, 3)[index], axis=1)


SKIN = skin(40, 30)


def queries(kind: str, count: int = 2000) -> Float[np.ndarray, "n 3"]:
    rng = np.random.default_rng(0)
    nodes = SKIN.reshape(-1, 3)
    some = nodes[rng.integers(0, len(nodes), count)]
    return {
        "near": lambda: some + rng.normal(0, 0.005, some.shape),
        "off": lambda: some + rng.normal(0, 0.1, some.shape),
        "anywhere": lambda: rng.uniform(-1, 2, some.shape),
        "far": lambda: rng.normal(0, 1e4, some.shape),
        "grey": lambda: np.repeat(rng.uniform(0, 1, (count, 1)), 3, 1),
        "dark": lambda: rng.uniform(-0.001, 0.001, some.shape),
        "one place": lambda: np.tile(some[:1] + 0.01, (count, 1)),
    }[kind]()


@pytest.mark.parametrize("pairs", [1 << 19, 1 << 12])
@pytest.mark.parametrize("kind", ["near", "off", "anywhere", "far", "grey", "dark", "one place"])
def test_it_agrees_with_brute_force(kind: str, pairs: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(nearest_colour, "_PAIRS", pairs)
    for colours in (queries(kind), queries(kind).astype(np.float32)):
        np.testing.assert_array_equal(NearestColour(SKIN)(colours), brute_force(SKIN, colours))


def test_a_node_is_its_own_nearest() -> None:
    np.testing.assert_array_equal(NearestColour(SKIN)(SKIN.reshape(-1, 3)), np.arange(40 * 30))


@pytest.mark.parametrize("axis", [0, 1])
def test_midway_either_node_is_right(axis: int) -> None:
    one, other = np.moveaxis(SKIN, axis, 0)[:-1], np.moveaxis(SKIN, axis, 0)[1:]
    colours = ((one + other) / 2).reshape(-1, 3)
    found = distance(SKIN, colours, NearestColour(SKIN)(colours))
    np.testing.assert_allclose(
        found, distance(SKIN, colours, brute_force(SKIN, colours)), rtol=1e-12
    )


@pytest.mark.parametrize("shape", [(25, 25), (1, 600), (2, 2), (1, 1)])
def test_any_grid_agrees_with_brute_force(
    shape: tuple[int, int], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(nearest_colour, "_PAIRS", 1 << 10)
    rng = np.random.default_rng(1)
    table = rng.normal(0, 1, (*shape, 3))
    colours = rng.normal(0, 1, (3000, 3))
    np.testing.assert_array_equal(NearestColour(table)(colours), brute_force(table, colours))


def test_nodes_may_coincide() -> None:
    table = np.repeat(SKIN, 3, 1)
    colours = queries("near")
    found = distance(table, colours, NearestColour(table)(colours))
    np.testing.assert_allclose(found, distance(SKIN, colours, brute_force(SKIN, colours)))


@pytest.mark.parametrize("count", [0, 1, 2])
def test_few_colours_are_enough(count: int) -> None:
    colours = queries("off", 10)[:count]
    np.testing.assert_array_equal(NearestColour(SKIN)(colours), brute_force(SKIN, colours))


def test_order_does_not_matter() -> None:
    colours = queries("off")
    order = np.random.default_rng(2).permutation(len(colours))
    search = NearestColour(SKIN)
    np.testing.assert_array_equal(search(colours)[order], search(colours[order]))


@pytest.mark.slow
def test_a_large_table_gives_the_answers_of_a_tree() -> None:
    table = skin(256, 256)
    rng = np.random.default_rng(3)
    near = table.reshape(-1, 3)[rng.integers(0, 256**2, 100_000)]
    for spread in (0.003, 0.03):
        colours = near + rng.normal(0, spread, near.shape)
        expected = cKDTree(table.reshape(-1, 3)).query(colours)[1]
        np.testing.assert_array_equal(NearestColour(table)(colours), expected)
