"""What heads of the variety `any` wear, and how often."""

from collections import Counter

import numpy as np
import pytest

from train.synthetic.garments.wardrobe import (
    FACE_MASK_SHARE,
    GLASSES_SHARE,
    HEADWEAR_SHARES,
    HOODS,
    NECKWEAR_SHARES,
    Wardrobe,
    sample_wardrobe,
)

COUNT = 4000


@pytest.fixture(scope="module")
def wardrobes() -> list[Wardrobe]:
    return [sample_wardrobe(np.random.default_rng([3, k])) for k in range(COUNT)]


def test_shares_are_those_that_are_documented(wardrobes: list[Wardrobe]) -> None:
    assert sum(HEADWEAR_SHARES.values()) == pytest.approx(1)
    assert sum(NECKWEAR_SHARES.values()) == pytest.approx(1)
    counts = Counter(one.headwear for one in wardrobes)
    for name, share in HEADWEAR_SHARES.items():
        assert counts[name] / COUNT == pytest.approx(share, abs=0.02)
    masked = [one.face_mask for one in wardrobes if one.headwear not in ("veil", "balaclava")]
    assert np.mean(masked) == pytest.approx(FACE_MASK_SHARE, abs=0.02)
    assert np.mean([one.glasses for one in wardrobes]) == pytest.approx(GLASSES_SHARE, abs=0.02)


def test_nothing_is_worn_twice(wardrobes: list[Wardrobe]) -> None:
    for one in wardrobes:
        assert one.neckwear == "none" or one.headwear not in HOODS
        assert not (one.face_mask and one.headwear in ("veil", "balaclava"))
        assert not (one.long_beard and (one.face_mask or one.headwear in HOODS))
