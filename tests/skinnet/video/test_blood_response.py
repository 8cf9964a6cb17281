"""Changes that are made with the response's own curves are found again, whatever the light."""

import numpy as np
import pytest

from skinnet.inference.full_resolution._colour_table import ColourTable
from skinnet.video._blood_response import BloodResponse
from skinnet.video._resting_maps import RestingMaps

TEXELS = 40


@pytest.fixture(scope="module")
def response() -> BloodResponse:
    melanin, blood = np.meshgrid(np.linspace(0, 1, 24) ** 2, np.linspace(0, 1, 24) ** 2,
                                 indexing="ij")  # fmt: skip
    depth = np.array([0.6, 1.6, 2.4]) * melanin[..., None] * 4 + np.array([0.6, 3, 2.4]) * (
        blood[..., None] * 3
    )
    table = ColourTable((0.8 * np.exp(-depth)).astype(np.float32), (0.4, 0.3))
    rng = np.random.default_rng(0)

    def make(low: float, high: float) -> np.ndarray:
        return rng.uniform(low, high, TEXELS).astype(np.float32)

    rest = RestingMaps(
        melanin=make(0.03, 0.05),
        hemoglobin=make(0.03, 0.06),
        gloss=make(0.0, 0.05),
        shading=make(0.5, 1.0),
        skin=np.ones(TEXELS, bool),
        capture={},
        pixel_sd=np.ones((2, TEXELS), np.float32),
        face_sd=np.ones(2),
        looks=1,
    )
    halves = np.arange(TEXELS) < TEXELS // 2
    return BloodResponse(table, rest, np.stack([halves, ~halves]))


@pytest.mark.parametrize("change", [-0.5, 0.02, 0.6])
def test_a_change_is_found_under_any_gain(response: BloodResponse, change: float) -> None:
    value, _ = response._evaluate(np.full(2, change))
    found = response.solve(value + np.array([[0.4], [-0.7]]), 1e-8 * np.stack([np.eye(3)] * 2), 0.0)
    assert np.allclose(found.change, change, atol=0.01)
    assert np.allclose(found.gain, [0.4, -0.7], atol=0.01)


def test_gloss_widens_the_interval_and_hardly_moves_the_change(response: BloodResponse) -> None:
    value, _ = response._evaluate(np.full(2, 0.2))
    noise = 1e-6 * np.stack([np.eye(3)] * 2)
    glossy = value + 0.01 * response.white
    sure, doubtful = (response.solve(glossy, noise, sd) for sd in (0.0, 0.02))
    assert (doubtful.sd > sure.sd).all()
    assert (np.abs(doubtful.change - 0.2) < np.abs(sure.change - 0.2)).all()


def test_more_noise_means_more_doubt(response: BloodResponse) -> None:
    sds = [
        response.solve(np.zeros((2, 3)), level * np.stack([np.eye(3)] * 2), 0.0).sd
        for level in (1e-6, 1e-4)
    ]
    assert np.allclose(sds[1] / sds[0], 10, rtol=0.1)
