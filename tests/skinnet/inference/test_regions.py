import json

import numpy as np
import pytest

from skinnet import Decomposer, Decomposition
from skinnet.errors import InputError
from skinnet.images.box import Box
from skinnet.images.faces._face_parts import FaceRegion
from skinnet.images.faces._face_regions import REGION_NAMES
from skinnet.images.faces._outlines import Patch
from skinnet.inference._regions import PigmentSummary, summarise_region

BOX = Box(10, 20, 20, 30)


def make_region(area: int = 100) -> FaceRegion:
    return FaceRegion(Patch(BOX, np.ones((10, 10), bool)), area)


def test_statistics_are_those_of_the_skin_in_the_region() -> None:
    melanin = np.linspace(0, 0.3, 100, dtype=np.float32).reshape(10, 10)
    skin = np.zeros((10, 10), bool)
    skin[:5] = True
    summary = summarise_region(make_region(), skin, melanin, melanin * 0 + np.float32(0.25))
    assert summary.pixels == 50 and summary.share == 0.5
    values = melanin[:5]
    expected = PigmentSummary(*map(float, (values.mean(), values.std(), np.median(values))))
    assert summary.melanin == pytest.approx(expected, rel=1e-5)
    assert summary.hemoglobin == PigmentSummary(0.25, 0, 0.25)


@pytest.mark.parametrize(("rows", "area"), [(2, 100), (4, 200), (0, 100)])
def test_regions_of_which_too_little_is_skin_have_no_pigments(rows: int, area: int) -> None:
    skin = np.zeros((10, 10), bool)
    skin[:rows] = True
    values = np.ones((10, 10), np.float32)
    summary = summarise_region(make_region(area), skin, values, values)
    assert summary.melanin == summary.hemoglobin == PigmentSummary(None, None, None)
    assert summary.pixels == 10 * rows and summary.share == 10 * rows / area
    assert summary.to_json()["melanin"] == {"mean": None, "std": None, "median": None}


def test_the_summary_has_regions_and_landmarks(decomposition: Decomposition) -> None:
    summary = json.loads(json.dumps(decomposition.summary(), allow_nan=False))
    assert tuple(summary["regions"]) == tuple(decomposition.regions) == REGION_NAMES
    landmarks = decomposition.landmarks
    assert landmarks is not None and landmarks.shape == (478, 2)
    np.testing.assert_allclose(summary["landmarks"], landmarks, atol=0.051)
    for name, region in decomposition.regions.items():
        numbers = summary["regions"][name]
        assert set(numbers) == {"melanin", "hemoglobin", "share", "pixels"}
        assert numbers["pixels"] == region.pixels == decomposition.region_mask(name).sum()
        skin = decomposition.region_mask(name)
        assert not (skin & (decomposition.mask <= 0.5)).any()
        if region.melanin.mean is not None:
            assert region.melanin.mean == pytest.approx(decomposition.melanin[skin].mean(), 1e-4)
            assert numbers["hemoglobin"]["median"] == region.hemoglobin.median


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
