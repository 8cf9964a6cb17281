"""Files of maps hold them exactly; damaged ones are refused."""

from pathlib import Path

import numpy as np
import pytest

from benchmarks.appearance import make_person
from skinnet.appearance import SkinColour, load_maps, save_maps
from skinnet.errors import InputError


def test_maps_come_back_exactly(tmp_path: Path, colour: SkinColour) -> None:
    face, path = make_person(20, 0), tmp_path / "a_maps.npz"
    save_maps(path, face, colour)
    found, seen = load_maps(path)
    assert found.name == str(path) and seen.to_record() == colour.to_record()
    for name in ("f_mel", "f_blood", "offset", "mask"):
        assert np.array_equal(getattr(found, name), getattr(face, name))


@pytest.mark.parametrize(
    "change", [{"offset": np.zeros((20, 20))}, {"mask": np.ones(20, bool)}, {"f_mel": "a"}]
)
def test_arrays_that_do_not_match_are_refused(
    tmp_path: Path, colour: SkinColour, change: dict[str, object]
) -> None:
    path = tmp_path / "a_maps.npz"
    save_maps(path, make_person(20, 0), colour)
    with np.load(path) as file:
        arrays = dict(file) | change
    np.savez(path, **arrays)
    with pytest.raises(InputError, match="is not a complete file"):
        load_maps(path)
