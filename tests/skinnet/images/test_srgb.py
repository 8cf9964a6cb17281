import numpy as np

from skinnet.images import linear_to_srgb, srgb_to_linear


def test_linear_and_srgb_are_inverse() -> None:
    every = np.arange(256, dtype=np.uint8)
    linear = srgb_to_linear(every)
    np.testing.assert_allclose(linear_to_srgb(linear) * 255, every, atol=1e-3)
    np.testing.assert_allclose(linear[[0, 1, 128, 255]], [0, 1 / 255 / 12.92, 0.2158605, 1], 1e-5)
    np.testing.assert_allclose(srgb_to_linear(every / 255), linear, atol=1e-6)
