"""Numbers of components at which a curve is measured."""

import numpy as np

from skinnet.appearance._curves import space_counts


def test_default_counts_are_all_or_spaced_by_ratio() -> None:
    assert space_counts(5).tolist() == [1, 2, 3, 4, 5]
    many = space_counts(998)
    assert len(many) <= 25 and many[0] == 1 and many[-1] == 998 and (np.diff(many) > 0).all()
