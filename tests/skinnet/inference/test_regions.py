import json

import numpy as np
import pytest

from skinnet import Decomposer, Decomposition
from skinnet.errors import InputError
from skinnet.images.box import Box
from skinnet.images.faces._face_parts import FaceRegion
from skinnet.images.faces._face_regions import REGION_NAMES
from skinnet.images.faces._outlines import Patch
from skinnet.inference._regions import Pigment, PigmentSummary, summarise_region
from skinnet.inference._uncertainty import Uncertainty

BOX = Box(10, 20, 20, 30)


def make_region(area: int = 100) -> FaceRegion:
    return FaceRegion(Patch(BOX, np.ones((10, 10), bool)), area)


def test_statistics_are_those_of_the_skin_in_the_region() -> None:
    melanin = np.linspace(0, 0.3, 100, dtype=np.float32).reshape(10, 10)
    skin = np.zeros((10, 10), bool)
    skin[:5] = True
    blood = Pigment(np.full_like(melanin, 0.25), 0.2, 0.3)
    summary = summarise_region(make_region(), skin, Pigment(melanin, 0.1, 0.4), blood)
    assert summary.pixels == 50 and summary.share == 0.5
    values = melanin[:5]
    spread = [float(each) for each in (values.mean(), values.std(), np.median(values))]
    assert summary.melanin[:3] == pytest.approx(spread, rel=1e-5)
    assert summary.melanin.sd == pytest.approx(0.1 * spread[0], rel=1e-5)
    factor = np.exp(0.1 * 1.644854)
    assert summary.melanin.interval == pytest.approx(
        [spread[0] / factor, spread[0] * factor], rel=1e-4
    )
    assert summary.hemoglobin[:4] == (0.25, 0, 0.25, 0.05)
    assert summary.hemoglobin.interval == pytest.approx((0.25 / np.exp(0.2 * 1.644854), 0.3))


def test_a_region_is_less_certain_than_the_face_by_the_share_of_its_pixels() -> None:
    pixels = np.full((4, 4), 0.5, np.float32)
    pixels[:2] = 0.2
    found = Uncertainty(pixels, pixels / 5, (0.3, 0.4), (0.25, 1.0))
    box = Box(100, 200, 140, 240)
    rows, columns = np.mgrid[220:240, 100:140].reshape(2, -1)  # the lower half: .5 and .1
    melanin, hemoglobin = found.of_region(box, rows, columns)
    assert melanin == pytest.approx(np.sqrt(0.3**2 + 0.25 * (0.5**2 - 0.3**2)))
    assert hemoglobin == pytest.approx(0.4)  # pixels that are surer than the face add nothing
    above = found.of_region(box, rows - 20, columns)
    assert above[0] == pytest.approx(0.3)


@pytest.mark.parametrize(("rows", "area"), [(2, 100), (4, 200), (0, 100)])
def test_regions_of_which_too_little_is_skin_have_no_pigments(rows: int, area: int) -> None:
    skin = np.zeros((10, 10), bool)
    skin[:rows] = True
    values = np.ones((10, 10), np.float32)
    pigment = Pigment(values, 0.1, 1.0)
    summary = summarise_region(make_region(area), skin, pigment, pigment)
    assert summary.melanin == summary.hemoglobin == PigmentSummary(None, None, None)
    assert summary.pixels == 10 * rows and summary.share == 10 * rows / area
    keys = ("mean", "std", "median", "sd", "interval")
    assert summary.to_json()["melanin"] == dict.fromkeys(keys)


def test_the_summary_has_regions_and_landmarks(decomposition: Decomposition) -> None:
    summary = json.loads(json.dumps(decomposition.summary(), allow_nan=False))
    assert tuple(summary["regions"]) == tuple(decomposition.regions) == REGION_NAMES
    landmarks = decomposition.landmarks
    assert landmarks is not None and landmarks.shape == (478, 2)
    np.testing.assert_allclose(summary["landmarks"], landmarks, atol=0.051)
    for name, region in decomposition.regions.items():
        numbers = summary["regions"][name]
        assert set(numbers) == {"melanin", "hemoglobin", "share", "pixels", "indices"}
        assert numbers["pixels"] == region.pixels == decomposition.region_mask(name).sum()
        skin = decomposition.region_mask(name)
        assert not (skin & (decomposition.mask <= 0.5)).any()
        if region.melanin.mean is not None:
            assert region.melanin.mean == pytest.approx(decomposition.melanin[skin].mean(), 1e-4)
            assert numbers["hemoglobin"]["median"] == region.hemoglobin.median
            low, high = numbers["melanin"]["interval"]
            assert low < region.melanin.mean < high and region.melanin.sd > 0


def test_sclera_and_teeth_are_masks_of_the_photograph(decomposition: Decomposition) -> None:
    for mask in (decomposition.sclera, decomposition.teeth):
        assert mask.shape == decomposition.mask.shape and mask.dtype == bool
    assert decomposition.teeth.any()


def test_without_a_face_there_are_no_parts(decomposer: Decomposer, astronaut: np.ndarray) -> None:
    decomposition = decomposer(astronaut[90:140, 200:250], region="skin", detail=False)
    summary = decomposition.summary()
    assert decomposition.landmarks is None and summary["landmarks"] is None
    assert decomposition.regions == summary["regions"] == {}
    assert not decomposition.sclera.any() and not decomposition.teeth.any()
    with pytest.raises(InputError, match="No face was looked for"):
        decomposition.region_mask("nose")


def test_names_of_regions_are_listed_to_who_errs(decomposition: Decomposition) -> None:
    with pytest.raises(InputError, match=r"forehead, .*eyelids; got 'cheek'"):
        decomposition.region_mask("cheek")
    with pytest.raises(KeyError, match=r"forehead, .*eyelids; got 'cheek'"):
        decomposition.regions["cheek"]
