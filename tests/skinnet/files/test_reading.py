"""Files that are no files, or never end, are refused before they are read."""

import os
import sys
from collections.abc import Callable
from io import BytesIO
from pathlib import Path

import pytest

from skinnet.errors import InputError
from skinnet.files._reading import open_file, read_file, read_stream
from skinnet.images import read_picture
from skinnet.images._result_names import compute_digest
from skinnet.inference import CaptureProfile
from skinnet.inference._onnx_header import read_header
from skinnet.mesh import read_mesh
from skinnet.physics._number_table import read_number_table
from skinnet.shape import read_landmarks

READERS: dict[str, Callable[[Path], object]] = {
    "a.png": read_picture,
    "a.bin": compute_digest,
    "a.onnx": read_header,
    "a.json": read_landmarks,
    "a.yaml": CaptureProfile.load,
    "a.csv": lambda path: read_number_table(path, 2, "is a table"),
}


@pytest.mark.parametrize("name", READERS)
@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="Windows has no named pipes in folders.")
def test_a_pipe_is_refused_and_not_waited_for(tmp_path: Path, name: str) -> None:
    os.mkfifo(tmp_path / name)
    with pytest.raises(InputError, match="pipe, socket or device"):
        READERS[name](tmp_path / name)


@pytest.mark.parametrize("suffix", [".obj", ".ply", ".glb", ".stl"])
@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="Windows has no named pipes in folders.")
def test_a_pipe_is_no_mesh(tmp_path: Path, suffix: str) -> None:
    os.mkfifo(tmp_path / f"a{suffix}")
    with pytest.raises(InputError, match=f"a{suffix}"):
        read_mesh(tmp_path / f"a{suffix}")


@pytest.mark.skipif(not Path("/dev/zero").exists(), reason="There is no endless device.")
def test_an_endless_device_is_refused() -> None:
    with pytest.raises(InputError, match="pipe, socket or device"):
        read_picture("/dev/zero")


def test_a_file_above_the_limit_is_not_read(tmp_path: Path) -> None:
    path = tmp_path / "a.jpg"
    with path.open("wb") as file:
        file.truncate(3_000_000_000)  # no byte of it is stored
    with pytest.raises(InputError, match="larger than the limit of 1,000 MB"):
        read_picture(path)
    assert read_file(_write(tmp_path / "b", b"12"), most=2) == b"12"
    with pytest.raises(InputError, match="b is larger"):
        read_file(tmp_path / "b", most=1)


def test_a_stream_above_the_limit_is_not_read_to_its_end() -> None:
    assert read_stream(BytesIO(b"12"), "standard input", 2) == b"12"
    with pytest.raises(InputError, match="standard input is larger"):
        read_stream(BytesIO(b"123"), "standard input", 2)


def test_folders_and_absent_files_are_errors_of_the_system(tmp_path: Path) -> None:
    for path in (tmp_path, tmp_path / "absent"):
        with pytest.raises(OSError, match=str(path) if sys.platform == "linux" else ""):
            with open_file(path):
                pass


def _write(path: Path, content: bytes) -> Path:
    path.write_bytes(content)
    return path
