"""Archives of arrays are measured before they are read, and damage is a `ValueError`."""

import errno
import io
import json
import os
import subprocess
import sys
import zipfile
from pathlib import Path

import numpy as np
import pytest

from skinnet.appearance.maps_file import load_maps
from skinnet.errors import InputError
from skinnet.files._npz import allocate_npy, check_zip, map_npy, read_npz
from skinnet.network import read_checkpoint
from skinnet.shape import load_shape_model

ARRAYS = {"a": np.arange(6.0).reshape(2, 3), "b": np.array("text"), "c": np.zeros((0, 3), bool)}


def write_member(path: Path, header: bytes, content: bytes = b"", name: str = "a.npy") -> Path:
    """Write an archive of one array whose header is as it is given."""
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr(name, header + content)
    return path


def make_header(description: str) -> bytes:
    text = description.encode().ljust(117) + b"\n"
    return b"\x93NUMPY\x01\x00" + len(text).to_bytes(2, "little") + text


def write_bomb(path: Path, name: str = "header.npy", gigabytes: int = 3) -> Path:
    """Write an archive of a few megabytes that unpacks to gigabytes of zeros."""
    size = gigabytes * 10**9
    described = f"{{'descr': '|u1', 'fortran_order': False, 'shape': ({size},), }}"
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED, compresslevel=1) as archive:
        with archive.open(name, "w", force_zip64=True) as stream:
            stream.write(make_header(described))
            block = bytes(10**7)
            for _ in range(size // len(block)):
                stream.write(block)
    return path


@pytest.mark.parametrize("save", [np.savez, np.savez_compressed])
def test_arrays_come_back(tmp_path: Path, save: object) -> None:
    save(tmp_path / "a.npz", f=np.asfortranarray(ARRAYS["a"]), **ARRAYS)
    found = read_npz(tmp_path / "a.npz")
    assert found.keys() == {"f", *ARRAYS}
    for name, array in ARRAYS.items():
        assert found[name].dtype == array.dtype and np.array_equal(found[name], array)
    assert np.array_equal(found["f"], ARRAYS["a"])
    assert list(read_npz(tmp_path / "a.npz", ["b"])) == ["b"]
    with pytest.raises(KeyError, match="z"):
        read_npz(tmp_path / "a.npz", ["z"])


@pytest.fixture(scope="module")
def bomb(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_bomb(tmp_path_factory.mktemp("bomb") / "bomb_maps.npz")


@pytest.mark.slow
@pytest.mark.parametrize("read", [load_maps, load_shape_model, read_npz, check_zip])
def test_a_bomb_is_refused_before_it_is_read(bomb: Path, read: object) -> None:
    with pytest.raises(InputError, match="would unpack to 3,000 MB"):
        read(bomb)


@pytest.mark.slow
def test_a_bomb_needs_no_memory(bomb: Path) -> None:
    code = (
        "import resource, sys\n"
        "from skinnet.files._npz import read_npz\n"
        "resource.setrlimit(resource.RLIMIT_AS, (2 * 10**9, 2 * 10**9))\n"
        "try:\n"
        f"    read_npz(__import__('pathlib').Path({str(bomb)!r}))\n"
        "except ValueError as error:\n"
        "    print(type(error).__name__)\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert done.stdout == "InputError\n", done.stderr


HEADERS = {
    "more than there is": "{'descr': '<f8', 'fortran_order': False, 'shape': (1000000000000,), }",
    "a negative size": "{'descr': '<f8', 'fortran_order': False, 'shape': (-1, -2), }",
    "objects": "{'descr': '|O', 'fortran_order': False, 'shape': (2,), }",
    "an open bracket": "{'descr': '<f8', 'fortran_order': False, 'shape': ((((((",
    "no end of a string": "{'descr': '<f8",
    "no type": "{'descr': 'zz', 'fortran_order': False, 'shape': (2,), }",
    "code": "__import__('os').system('true')",
    "no text": "\u0000\u00ff",
}


@pytest.mark.parametrize("kind", HEADERS)
def test_damaged_headers(tmp_path: Path, kind: str) -> None:
    path = write_member(tmp_path / "a.npz", make_header(HEADERS[kind]), bytes(16))
    with pytest.raises(ValueError, match=r"."):
        read_npz(path)
    with pytest.raises(InputError, match=r"a\.npz"):
        load_shape_model(path)
    with pytest.raises(InputError, match=r"a\.npz"):
        load_maps(path)


def test_what_is_no_archive(tmp_path: Path) -> None:
    whole = io.BytesIO()
    np.savez(whole, **ARRAYS)
    for content in (b"", b"PK\x03\x04", whole.getvalue()[:300], b"\x93NUMPY", bytes(1000)):
        (tmp_path / "a.npz").write_bytes(content)
        with pytest.raises(ValueError, match=r"."):
            read_npz(tmp_path / "a.npz")


def test_a_checkpoint_that_unpacks_to_gigabytes_is_refused(bomb: Path, tmp_path: Path) -> None:
    path = tmp_path / "a.ckpt"
    path.symlink_to(bomb)
    with pytest.raises(InputError, match="would unpack"):
        read_checkpoint(path)


def test_a_bomb_in_basels_format(tmp_path: Path) -> None:
    h5py = pytest.importorskip("h5py")
    with h5py.File(tmp_path / "a.h5", "w") as file:
        size = (400_000_000,)
        file.create_dataset("shape/model/mean", size, "f8", compression="gzip", chunks=(10**6,))
        for name in ("model/pcaBasis", "model/pcaVariance", "representer/cells"):
            file[f"shape/{name}"] = np.zeros(3)
    with pytest.raises(InputError, match="would unpack to 3,200 MB"):
        load_shape_model(tmp_path / "a.h5")


def test_a_header_of_a_model_that_is_no_object(tmp_path: Path) -> None:
    np.savez(tmp_path / "a.npz", header=np.array(json.dumps([1])))
    with pytest.raises(InputError, match=r"a\.npz"):
        load_maps(tmp_path / "a.npz")


def test_an_array_is_mapped_and_a_damaged_one_refused(tmp_path: Path) -> None:
    path = tmp_path / "a.npy"
    allocate_npy(path, np.float32, (2, 3))
    map_npy(path, writable=True)[1] = 7
    assert map_npy(path).tolist() == [[0, 0, 0], [7, 7, 7]]
    whole = path.read_bytes()
    for damaged in (whole[:-1], whole + b"0", whole[:20], b"", whole.replace(b"(2, 3)", b"((2, 3")):
        path.write_bytes(damaged)
        with pytest.raises(ValueError, match=r"\S"):
            map_npy(path)


def test_a_map_takes_its_room_at_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_: object) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(os, "posix_fallocate", refuse, raising=False)
    with pytest.raises(OSError, match=r"No space left on device: .*a\.npy"):
        allocate_npy(tmp_path / "a.npy", bool, (9,))
    assert not any(tmp_path.iterdir())
