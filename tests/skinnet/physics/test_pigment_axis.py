"""The axis of pigment tables: equal steps of log(1 + f / spacing), there and back."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from skinnet.physics._pigment_axis import PigmentAxis

AXES = [
    PigmentAxis(0.0, 1.0, 95, 0.004),
    PigmentAxis(0.0, 0.43, 256, 0.02),
    PigmentAxis(0.05, 0.2, 2, 0.5),
]


@pytest.mark.parametrize("axis", [*AXES, PigmentAxis(0.0, 0.43, 256, 0.0485430328)])
def test_the_ends_are_exactly_those_of_the_range(axis: PigmentAxis) -> None:
    ends = axis.fractions(np.array([0.0, axis.nodes - 1.0]))
    assert ends.tolist() == [axis.low, axis.high]


@pytest.mark.parametrize("axis", AXES)
def test_nodes_are_equal_steps_of_the_logarithm(axis: PigmentAxis) -> None:
    fractions = axis.fractions(np.arange(axis.nodes, dtype=float))
    steps = np.diff(np.log1p(fractions / axis.spacing))
    np.testing.assert_allclose(steps, axis.step, rtol=1e-9)


@given(
    st.floats(0, 0.4),
    st.floats(0.01, 0.6),
    st.integers(2, 300),
    st.floats(1e-4, 1),
    st.floats(0, 1),
)
def test_a_position_comes_back(
    low: float, width: float, nodes: int, spacing: float, share: float
) -> None:
    axis = PigmentAxis(low, low + width, nodes, spacing)
    position = share * (nodes - 1)
    scale, shift = axis.scale_and_shift
    (fraction,) = axis.fractions(np.array([position]))
    assert scale * np.log(fraction + spacing) + shift == pytest.approx(position, abs=1e-6)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_fractions_stay_in_range_and_precision(dtype: type) -> None:
    axis = AXES[1]
    fractions = axis.fractions(np.linspace(-1, axis.nodes, 50).astype(dtype))
    assert fractions.dtype == dtype
    assert fractions.min() == 0 and fractions.max() == np.array(0.43, dtype)
