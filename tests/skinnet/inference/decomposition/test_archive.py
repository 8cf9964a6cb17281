"""A file holds all of a decomposition, exactly, and a damaged one is refused in a sentence."""

import io
import json
import zipfile
from dataclasses import fields
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

from skinnet import Decomposer, Decomposition
from skinnet.errors import InputError
from skinnet.images import read_picture


def assert_same(found: Any, expected: Any) -> None:
    """Compare types and values, within tuples and mappings too."""
    if isinstance(expected, np.ndarray):
        assert found.dtype == expected.dtype
        np.testing.assert_array_equal(found, expected)
    elif isinstance(expected, dict):
        assert list(found) == list(expected)
        for name, value in expected.items():
            assert_same(found[name], value)
    elif isinstance(expected, tuple | list):
        assert type(found) is type(expected) and len(found) == len(expected)
        for one, other in zip(found, expected, strict=True):
            assert_same(one, other)
    else:
        assert found == expected


def assert_kept(loaded: Decomposition, saved: Decomposition) -> None:
    for field in fields(saved):
        if field.name != "_source":
            assert_same(getattr(loaded, field.name), getattr(saved, field.name))
    assert loaded.to_dict() == saved.to_dict()
    assert repr(loaded) == repr(saved)
    assert loaded._repr_html_() == saved._repr_html_()
    np.testing.assert_array_equal(loaded.melanin_sd, saved.melanin_sd)
    np.testing.assert_array_equal(np.asarray(loaded.plot()), np.asarray(saved.plot()))


def keep(saved: Decomposition, path: Path, decomposer: Decomposer) -> Decomposition:
    saved.save(path)
    loaded = Decomposition.load(path, decomposer=decomposer)
    assert_kept(loaded, saved)
    return loaded


def test_the_shipped_models_reading_is_kept(astronaut: np.ndarray, tmp_path: Path) -> None:
    shipped = Decomposer(threads=1)
    large = Image.fromarray(astronaut[50:250, 130:330]).resize((800, 800))
    read = shipped(large)
    assert read.indices() is not None and read.regions["nose"].indices is not None
    read.save(tmp_path / "a.npz")
    loaded = Decomposition.load(str(tmp_path / "a.npz"))
    assert_kept(loaded, read)
    edited = shipped.edit(large, 2.0, 0.5)
    np.testing.assert_array_equal(loaded.edit(2.0, 0.5), edited)
    assert loaded.sclera.any()
    for name in ("sclera", "teeth"):
        np.testing.assert_array_equal(getattr(loaded, name), getattr(read, name))
    np.testing.assert_array_equal(loaded.region_mask("nose"), read.region_mask("nose"))


def test_tilted_heads_profiles_depth_and_alpha_are_kept(
    decomposer: Decomposer, astronaut: np.ndarray, tmp_path: Path
) -> None:
    turned = np.asarray(Image.fromarray(astronaut).rotate(25, fillcolor=(90, 120, 150)))
    alpha = np.full(turned.shape[:2], 255, np.uint8)
    alpha[:, :40] = 0
    deep = np.dstack([turned, alpha]).astype(np.uint16) * 257
    picture = read_picture(deep, "deep", colour_space="Display P3")
    saved = decomposer(picture)
    assert saved.tilt is not None and abs(saved.tilt) > 8
    loaded = keep(saved, tmp_path / "a.npz", decomposer)
    expected = decomposer.edit(picture, 3.0)
    for each in (saved, loaded):
        np.testing.assert_array_equal(each.edit(3.0), expected)


def test_bare_skin_and_no_skin_are_kept(
    decomposer: Decomposer, skinless_file: Path, astronaut: np.ndarray, tmp_path: Path
) -> None:
    bare = decomposer(astronaut[110:150, 235:260], region="skin")
    assert bare.face_parts is None and bare.notes
    keep(bare, tmp_path / "bare.npz", decomposer)
    blind = Decomposer(skinless_file, threads=1)
    keep(blind(astronaut), tmp_path / "blind.npz", blind)


def test_other_models_do_not_edit_it(decomposition: Decomposition, tmp_path: Path) -> None:
    decomposition.save(tmp_path / "a.npz")
    loaded = Decomposition.load(tmp_path / "a.npz")
    with pytest.raises(InputError, match=r"with another model \(version 0\.1\.0, paper\)"):
        loaded.edit(2.0)


def test_only_npz_files_that_can_be_are_written(
    decomposition: Decomposition, tmp_path: Path
) -> None:
    with pytest.raises(InputError, match=r"a\.png must end in \.npz"):
        decomposition.save(tmp_path / "a.png")
    with pytest.raises(InputError, match=r"cannot be written \(No such file or directory\)"):
        decomposition.save(tmp_path / "absent" / "a.npz")
    (tmp_path / "b.npz").mkdir()
    with pytest.raises(InputError, match="is a folder"):
        decomposition.save(tmp_path / "b.npz")
    with pytest.raises(InputError, match="is a folder; give a file"):
        Decomposition.load(tmp_path / "b.npz")
    with pytest.raises(InputError, match=r"There is no file .*c\.npz; check the path"):
        Decomposition.load(tmp_path / "c.npz")
    assert [path.name for path in tmp_path.iterdir()] == ["b.npz"]


@pytest.fixture(scope="module")
def content(decomposition: Decomposition, tmp_path_factory: pytest.TempPathFactory) -> bytes:
    path = tmp_path_factory.mktemp("saved") / "a.npz"
    decomposition.save(path)
    return path.read_bytes()


def rewrite(content: bytes, path: Path, change: Any) -> Path:
    """Write the file with its header or its arrays changed."""
    with np.load(io.BytesIO(content)) as archive:
        arrays = dict(archive)
    header = json.loads(arrays["header"].tobytes())
    change(header, arrays)
    arrays["header"] = np.frombuffer(json.dumps(header).encode(), np.uint8)
    np.savez(path, **arrays)
    return path


def set_header(name: str, value: Any) -> Any:
    return lambda header, arrays: header.update({name: value})


def set_array(name: str, value: Any) -> Any:
    return lambda header, arrays: arrays.update({name: value})


@pytest.mark.parametrize(
    "change",
    [
        set_header("kind", "other"),
        set_header("shape", [10**9, 10**9]),
        set_header("shape", [512, "a"]),
        set_header("box", [0, 0, 600, 512]),
        set_header("box", [0, 0, 5, 5]),
        set_header("notes", None),
        set_header("source", {}),
        set_header("uncertainty", [[0.1], [1.0]]),
        set_header("uncertainty", [[0.1, float("inf")], [1.0, 1.0]]),
        set_array("log_sd_melanin", np.ones((1, 1), np.float32)),
        set_array("log_sd_melanin", np.full((160, 160), np.nan, np.float32)),
        set_header("output_info", {"melanin": ["a", [0.0], "b"]}),
        set_array("melanin", np.zeros((3, 3), np.float32)),
        set_array("mask", np.array([None])),
        set_array("photo", np.zeros((512, 512, 3), np.float32)),
        set_array("patches", np.zeros(3, bool)),
        set_array("edit_mask", np.zeros((1, 2, 2), np.float32)),
        lambda header, arrays: arrays.pop("hemoglobin"),
    ],
)
def test_a_changed_file_is_refused(content: bytes, change: Any, tmp_path: Path) -> None:
    path = rewrite(content, tmp_path / "a.npz", change)
    with pytest.raises(InputError, match=r"a\.npz is no decomposition, or it is damaged \("):
        Decomposition.load(path)


def test_the_untouched_file_is_read_by_numpy_too(content: bytes, tmp_path: Path) -> None:
    path = rewrite(content, tmp_path / "a.npz", lambda header, arrays: None)
    assert Decomposition.load(path).means["melanin"] > 0


def test_a_newer_format_says_so(content: bytes, tmp_path: Path) -> None:
    path = rewrite(content, tmp_path / "a.npz", set_header("format", 2))
    with pytest.raises(InputError, match=r"has format 2, and this skinnet reads 1; .*pip install"):
        Decomposition.load(path)


def test_a_bomb_is_refused_before_it_is_read(content: bytes, tmp_path: Path) -> None:
    path = tmp_path / "a.npz"
    head = io.BytesIO()
    np.lib.format.write_array_header_1_0(
        head, {"descr": "<f4", "fortran_order": False, "shape": (10**6, 10**6)}
    )
    with (
        zipfile.ZipFile(io.BytesIO(content)) as old,
        zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as new,
    ):
        for name in old.namelist():
            new.writestr(name, head.getvalue() if name == "melanin.npy" else old.read(name))
    with pytest.raises(InputError, match=r"melanin\.npy is not the array that it states"):
        Decomposition.load(path)


def test_what_would_fill_the_memory_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "a.npz"
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("header.npy", bytes(150_000_000))
    with pytest.raises(InputError, match="it would unpack to 1 files of 150,000,000 bytes"):
        Decomposition.load(path)
    with zipfile.ZipFile(path, "w") as archive:
        for number in range(200):
            archive.writestr(f"{number}.npy", b"")
    with pytest.raises(InputError, match="it would unpack to 200 files"):
        Decomposition.load(path)
