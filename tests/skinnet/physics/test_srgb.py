"""sRGB: luminance is colour-science's, display values are clipped."""

import warnings

import numpy as np
import pytest
import torch

with warnings.catch_warnings():
    # colour-science says at import which of its optional parts are absent.
    warnings.simplefilter("ignore")
    import colour

from skinnet.physics.srgb import luminance, to_display


def colour_luminance(linear: np.ndarray) -> np.ndarray:
    """colour-science's Y of linear sRGB, channels last, with the matrix of the primaries."""
    space = colour.RGB_COLOURSPACES["sRGB"].copy()
    space.use_derived_transformation_matrices(True)
    return colour.RGB_to_XYZ(linear, space)[..., 1]


@pytest.mark.parametrize("shape", [(), (4,), (2, 3)])
@pytest.mark.parametrize(("dtype", "error"), [(torch.float64, 1e-12), (torch.float32, 1e-6)])
def test_luminance_agrees_with_colour_science(
    shape: tuple[int, ...], dtype: torch.dtype, error: float
) -> None:
    linear = np.random.default_rng(0).uniform(-0.2, 1.4, (*shape, 5, 6, 3))
    found = luminance(torch.tensor(linear, dtype=dtype).movedim(-1, -3))
    assert found.shape == (*shape, 1, 5, 6) and found.dtype == dtype
    assert found[..., 0, :, :].numpy() == pytest.approx(colour_luminance(linear), abs=error)


def test_luminance_has_the_printed_weights() -> None:
    found = luminance(torch.eye(3, dtype=torch.float64)[..., None, None]).flatten()
    assert found.numpy() == pytest.approx([0.2126, 0.7152, 0.0722], abs=5e-5)
    assert luminance(torch.ones(3, 1, 1)).item() == pytest.approx(1, abs=1e-6)


def test_display_is_clipped_srgb() -> None:
    linear = torch.tensor([-1.0, 0.0, 0.002, 0.2, 1.0, 3.0], dtype=torch.float64).expand(3, 1, 6)
    expected = torch.tensor([0, 0, 0.02584, 0.48453, 1, 1], dtype=torch.float64).expand(3, 1, 6)
    assert torch.allclose(to_display(linear), expected, atol=1e-5)
