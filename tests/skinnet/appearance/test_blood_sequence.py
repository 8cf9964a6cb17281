"""Sequences are checked, and read from what `skinnet track` writes."""

from pathlib import Path

import numpy as np
import pytest
from skimage.data import astronaut

from skinnet.appearance import BloodSequence, DynamicModel
from skinnet.errors import InputError
from skinnet.images import find_faces


@pytest.fixture(scope="module")
def model() -> DynamicModel:
    return DynamicModel.load()


def test_sequences_are_checked() -> None:
    rest = np.full((8, 8), 0.05)
    with pytest.raises(InputError, match="one square map at rest"):
        BloodSequence(rest, rest, np.arange(2.0), {})
    maps = np.stack([rest, rest])
    with pytest.raises(InputError, match="seconds that increase"):
        BloodSequence(rest, maps, np.zeros(2), {})
    with pytest.raises(InputError, match="flush needs one finite amount for each of the 2 times"):
        BloodSequence(rest, maps, np.arange(2.0), {"flush": np.zeros(3)})
    with pytest.raises(InputError, match="give coefficients"):
        DynamicModel.fit([BloodSequence(rest, maps, np.arange(2.0), {})])


def test_tracks_are_read(model: DynamicModel, tmp_path: Path) -> None:
    names = ("forehead", "left_cheek", "right_cheek", "nose", "lips", "chin")
    table = tmp_path / "a_track.csv"
    head = ",".join(["time", *(f"{name}_log_ratio" for name in names)])
    table.write_text(f"{head}\n0,0,0,0,0,0,0\n1,.2,.5,.5,.3,.1,.2\n2,,,,,,\n")
    sequence = BloodSequence.from_track(table)
    assert sequence.maps.shape[0] == 3 and np.isnan(sequence.maps[2]).all()
    assert np.array_equal(sequence.maps[0], sequence.rest)
    cheek = tuple((model.landmarks[50, ::-1] * len(sequence.rest)).astype(int))
    change = np.log(sequence.maps[1] / sequence.rest)
    assert change[cheek] == pytest.approx(0.5, abs=0.1)
    amount = model.explain(sequence, ["flush"])["flush"]
    assert amount[0] == 0 and 0.2 < amount[1] < 0.6
    known = BloodSequence.from_track(table, {"warm": np.array([0, 1.0, 1.0])})
    assert DynamicModel.fit([known], seconds={}).mean.max() > 0.3


def test_maps_of_pictures_are_laid_out(model: DynamicModel) -> None:
    landmarks = find_faces(astronaut())[0].landmarks
    rest = np.full((512, 512), 0.04, np.float32)
    rest[:60] = np.nan
    flushed = model.sample(rest[::2, ::2], {"flush": 0.6}, landmarks / 2)
    sequence = BloodSequence.from_pictures(
        [rest, flushed], [landmarks, landmarks / 2], np.arange(2.0)
    )
    assert sequence.maps.shape == (2, 96, 96) and np.isnan(sequence.rest[0, 0])
    found = model.explain(sequence, ["flush", "pallor"])
    assert found["flush"].tolist() == pytest.approx([0, 0.6], abs=0.03)
    assert found["pallor"].tolist() == pytest.approx([0, 0], abs=0.02)
    with pytest.raises(InputError, match="got 1 and 0"):
        BloodSequence.from_pictures([rest], [], np.arange(1.0))


@pytest.mark.parametrize("text", ["", "time,other\n0,1\n", "time,forehead_log_ratio\nx,y\n"])
def test_other_tables_are_refused(tmp_path: Path, text: str) -> None:
    table = tmp_path / "a.csv"
    table.write_text(text)
    with pytest.raises(InputError, match=r"skinnet track|has no rows"):
        BloodSequence.from_track(table)
    with pytest.raises(InputError, match="cannot be read"):
        BloodSequence.from_track(tmp_path / "absent.csv")
