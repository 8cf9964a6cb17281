"""Casts on disk: made once, and never used in part."""

from pathlib import Path

import numpy as np
import pytest

from skinnet.errors import InputError
from train.synthetic.bodies.labelled_mesh import label_mesh, triangulate_grid
from train.synthetic.casts import head_cache
from train.synthetic.casts.head_cast import HeadCast
from train.synthetic.labels import SKIN

SIZE = 12


@pytest.fixture
def cast_numbers(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """Numbers of the heads that were cast; all are one dish, which takes no time."""
    x, y = np.meshgrid(np.linspace(-1, 1, 9), np.linspace(1, -1, 9))
    points = np.stack([x, y, 0.5 * (x**2 + y**2)], -1).reshape(-1, 3)
    head = label_mesh(points, triangulate_grid(9, 9), SKIN, points[:, :2])
    numbers: list[int] = []
    cast = head_cache._cast

    def count(job: head_cache._Job) -> int:
        numbers.append(job[3])
        return cast(job)

    monkeypatch.setattr(head_cache, "_cast", count)
    monkeypatch.setattr(head_cache, "make_procedural_head", lambda rng, variety: head)
    return numbers


def test_casts_are_made_once(tmp_path: Path, cast_numbers: list[int]) -> None:
    first = head_cache.load_or_cast_heads(tmp_path, SIZE, 2, "val", 0)
    second = head_cache.load_or_cast_heads(tmp_path, SIZE, 2, "val", 0)
    assert cast_numbers == [0, 1] and first.label.shape == (2, SIZE, SIZE)
    assert first.label.any() and (first.visibility_mask[0] != first.visibility_mask[1]).any()
    _same(first, second)


@pytest.mark.slow
def test_several_processes_cast_the_same(tmp_path: Path) -> None:
    one = head_cache.load_or_cast_heads(tmp_path / "one", SIZE, 3, "val", seed=0)
    two = head_cache.load_or_cast_heads(tmp_path / "two", SIZE, 3, "val", seed=0, workers=2)
    assert all(np.array_equal(a, b) for a, b in zip(one, two, strict=True))


def test_files_keep_the_names_of_their_arrays(tmp_path: Path, cast_numbers: list[int]) -> None:
    head_cache.load_or_cast_heads(tmp_path, SIZE, 1, "val", 0)
    (file,) = tmp_path.rglob("val_00000.npz")
    with np.load(file) as arrays:
        assert set(arrays) == {"settings", "label", "normal", "chart", "openness", "seen"}


def test_more_heads_leave_the_first_as_they_were(tmp_path: Path, cast_numbers: list[int]) -> None:
    one = head_cache.load_or_cast_heads(tmp_path, SIZE, 1, "train", 0)
    three = head_cache.load_or_cast_heads(tmp_path, SIZE, 3, "train", 0)
    assert cast_numbers == [0, 1, 2]
    _same(one, HeadCast(*(array[:1] for array in three)))


def test_splits_and_seeds_share_no_head(tmp_path: Path, cast_numbers: list[int]) -> None:
    ways = [("train", 0), ("val", 0), ("test", 0), ("train", 1)]
    casts = [head_cache.load_or_cast_heads(tmp_path, SIZE, 1, *way).chart.tobytes() for way in ways]
    assert len(set(casts)) == 4


def test_a_file_cut_short_is_cast_again(tmp_path: Path, cast_numbers: list[int]) -> None:
    first = head_cache.load_or_cast_heads(tmp_path, SIZE, 2, "val", 0)
    (file,) = tmp_path.rglob("val_00001.npz")
    file.write_bytes(file.read_bytes()[:-300])
    _same(first, head_cache.load_or_cast_heads(tmp_path, SIZE, 2, "val", 0))
    assert cast_numbers == [0, 1, 1]


def test_a_file_with_a_changed_byte_is_cast_again(tmp_path: Path, cast_numbers: list[int]) -> None:
    first = head_cache.load_or_cast_heads(tmp_path, SIZE, 1, "val", 0)
    (file,) = tmp_path.rglob("val_00000.npz")
    data = bytearray(file.read_bytes())
    data[len(data) // 2] ^= 255
    file.write_bytes(data)
    _same(first, head_cache.load_or_cast_heads(tmp_path, SIZE, 1, "val", 0))
    assert cast_numbers == [0, 0]


def test_a_file_of_another_version_is_cast_again(
    tmp_path: Path, cast_numbers: list[int], monkeypatch: pytest.MonkeyPatch
) -> None:
    head_cache.load_or_cast_heads(tmp_path, SIZE, 1, "val", 0)
    (old,) = tmp_path.rglob("val_00000.npz")
    monkeypatch.setattr(head_cache, "VERSION", head_cache.VERSION + 1)
    head_cache.load_or_cast_heads(tmp_path, SIZE, 1, "val", 0)
    (new,) = (file for file in tmp_path.rglob("val_00000.npz") if file != old)
    # Not even under the new version's name.
    old.replace(new)
    head_cache.load_or_cast_heads(tmp_path, SIZE, 1, "val", 0)
    assert cast_numbers == [0, 0, 0]


def test_a_file_of_another_size_is_cast_again(tmp_path: Path, cast_numbers: list[int]) -> None:
    for size in (SIZE, SIZE + 1):
        head_cache.load_or_cast_heads(tmp_path, size, 1, "val", 0)
    (file,) = (tmp_path / f"v{head_cache.VERSION}-{SIZE}px-seed0-procedural").iterdir()
    (other,) = (tmp_path / f"v{head_cache.VERSION}-{SIZE + 1}px-seed0-procedural").iterdir()
    other.replace(file)
    assert head_cache.load_or_cast_heads(tmp_path, SIZE, 1, "val", 0).label.any()
    assert cast_numbers == [0, 0, 0]


def test_nothing_unfinished_is_left(tmp_path: Path, cast_numbers: list[int]) -> None:
    head_cache.load_or_cast_heads(tmp_path, SIZE, 1, "val", 0)
    assert [file.name for file in tmp_path.rglob("*.npz")] == ["val_00000.npz"]


def test_a_message_says_that_all_heads_are_procedural(
    tmp_path: Path, cast_numbers: list[int], capsys: pytest.CaptureFixture[str]
) -> None:
    head_cache.load_or_cast_heads(tmp_path, SIZE, 1, "val", 0)
    message = capsys.readouterr().err
    assert message.count("all heads are procedural") == 1
    assert "Heads of val: 1 of 1 cast." in message


def test_most_heads_are_of_ict(tmp_path: Path, ict_file: Path) -> None:
    casts = head_cache.load_or_cast_heads(tmp_path, SIZE, 2, "train", 0, ict_file)
    again = head_cache.load_or_cast_heads(tmp_path, SIZE, 2, "train", 0, ict_file)
    _same(casts, again)
    (place,) = tmp_path.iterdir()
    assert "-ict" in place.name


def _same(one: HeadCast, other: HeadCast) -> None:
    for a, b in zip(one, other, strict=True):
        np.testing.assert_array_equal(a, b)


def test_a_folder_that_cannot_be_made_is_named(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    with pytest.raises(InputError, match=r"file.* cannot be made \(Not a directory\)"):
        head_cache.load_or_cast_heads(tmp_path / "file", 8, 1, "train", 0)
