import numpy as np
import pytest

from skinnet.images import resize


@pytest.mark.parametrize("dtype", [np.uint8, np.float32])
def test_an_even_image_stays_even(dtype: type) -> None:
    image = np.full((7, 9, 3) if dtype is np.uint8 else (7, 9), 100, dtype)
    for size in ((3, 2), (9, 7), (20, 31)):
        resized = resize(image, *size)
        assert resized.shape[:2] == size[::-1] and resized.dtype == dtype
        assert (resized == 100).all()


def test_shrinking_averages_and_enlarging_interpolates() -> None:
    checks = np.indices((64, 64)).sum(0).astype(np.float32) % 2
    np.testing.assert_allclose(resize(checks, 8, 8)[1:-1, 1:-1], 0.5, atol=0.01)
    ramp = np.arange(8, dtype=np.float32)[None].repeat(8, 0)
    np.testing.assert_allclose(np.diff(resize(ramp, 16, 8)[0, 1:-1]), 0.5, atol=1e-6)
