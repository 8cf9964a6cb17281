from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from skimage import data

from skinnet.images import find_faces, read_photo
from skinnet.images._bare_skin import segment_bare_skin


def test_skin_that_fills_the_picture_is_skin(astronaut: np.ndarray) -> None:
    assert segment_bare_skin(astronaut[120:150, 235:250]).mean() > 0.9


@pytest.mark.parametrize("name", ["coffee", "rocket", "retina"])
def test_pictures_without_skin_have_none(name: str) -> None:
    photo = getattr(data, name)()
    assert segment_bare_skin(photo).max() == 0


@given(hnp.arrays(np.uint8, st.tuples(st.integers(1, 30), st.integers(1, 30), st.just(3))))
def test_a_mask_is_made_of_anything(photo: np.ndarray) -> None:
    mask = segment_bare_skin(photo)
    assert mask.shape == photo.shape[:2]
    assert mask.min() >= 0 and mask.max() <= 1


def test_necks_are_skin_and_walls_are_not(shared_data: Path) -> None:
    for path in sorted((shared_data / "faces" / "london").glob("*.jpg"))[::9]:
        photo = read_photo(path)
        box = find_faces(photo)[0].box
        side = box.width
        below = photo[box.bottom - side // 8 : box.bottom + side // 2, box.left : box.right]
        assert 0.5 < segment_bare_skin(below).mean() < 0.95, path.name
        assert segment_bare_skin(photo[: side // 2, : side // 2]).max() == 0, path.name
