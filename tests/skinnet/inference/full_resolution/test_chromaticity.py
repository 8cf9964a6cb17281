from concurrent.futures import ThreadPoolExecutor

import numpy as np
from painted_skin import SIZE, Maps, photograph_maps, reduce_maps

from skinnet import SkinDecoder
from skinnet.inference.full_resolution._chromaticity import (
    estimate_covariance,
    measure_log_colours,
    reduce_to_log_rgb,
)


def test_noise_is_estimated_despite_outliers() -> None:
    rng = np.random.default_rng(0)
    covariance = np.array([[4.0, 1.0], [1.0, 1.0]])
    values = np.float32(np.linalg.cholesky(covariance) @ rng.standard_normal((2, 40_000)))
    values = values.reshape(2, 200, 200)
    values[:, :4] = 100
    estimated = estimate_covariance(values, np.ones((200, 200), np.float32))
    np.testing.assert_allclose(estimated, covariance, rtol=0.15, atol=0.1)
    assert not estimate_covariance(values, np.zeros((200, 200), np.float32)).any()


def test_saturated_pixels_take_the_colours_of_skin_nearby(skin: SkinDecoder, truth: Maps) -> None:
    photo, maps = photograph_maps(skin, truth, noise=0), reduce_maps(truth)
    photo[200:220, 200:220] = 255
    with ThreadPoolExecutor(1) as pool:
        colours = measure_log_colours(photo, maps, (SIZE, SIZE), pool)
    assert not colours.weight[202:218, 202:218].any()
    assert colours.weight[300:, 300:].mean() > 0.9
    spot = colours.channels[:, 202:218, 202:218].mean((1, 2))
    nearby = colours.channels[:, 180:240, 180:240].mean((1, 2))
    np.testing.assert_allclose(spot, nearby, atol=0.1)
    assert reduce_to_log_rgb(colours, (40, 40)).shape == (3, 40, 40)
