import numpy as np

from skinnet.images._connected_parts import keep_large, keep_small, label_parts

AREA = np.array([[1, 1, 1, 0, 1, 0, 1], [1, 0, 0, 0, 1, 0, 0]], bool)
"""Parts of 4, 2 and 1 pixels."""


def test_parts_are_labelled_and_counted() -> None:
    labels, sizes = label_parts(AREA)
    assert sizes.tolist() == [0, 4, 2, 1] and labels.max() == 3
    assert label_parts(np.zeros((2, 2), bool))[1].tolist() == [0]


def test_parts_are_kept_by_their_size() -> None:
    assert np.flatnonzero(keep_small(AREA, 3.0).any(0)).tolist() == [4, 6]
    assert np.flatnonzero(keep_large(AREA, 0.5).any(0)).tolist() == [0, 1, 2]
    assert np.flatnonzero(keep_large(AREA, 0.4).any(0)).tolist() == [0, 1, 2, 4]


def test_nothing_has_no_parts() -> None:
    nothing = np.zeros((3, 3), bool)
    assert not keep_small(nothing, 5.0).any() and not keep_large(nothing, 0.1).any()
