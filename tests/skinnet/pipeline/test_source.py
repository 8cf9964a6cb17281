"""Whose results the files of a folder are."""

import json
from pathlib import Path

import numpy as np
import pytest

from skinnet.errors import InputError
from skinnet.images._png_file import write_png
from skinnet.mesh import Mesh, write_mesh
from skinnet.pipeline._source import Source, choose_folder, find_result_verb, read_result_mark


@pytest.fixture
def scans(tmp_path: Path) -> list[Source]:
    for name in "ab":
        (tmp_path / f"{name}.obj").write_text(f"# {name}\nv 0 0 0\n")
    return [Source.read([tmp_path / f"{name}.obj"]) for name in "ab"]


def write_results(folder: Path, source: Source) -> list[Path]:
    """Write a file of each kind."""
    folder.mkdir()
    origin = source.describe("maps", "maps", folder)
    text = source.make_mark("maps", "face").to_text()
    (folder / "a_maps.json").write_text(json.dumps(origin))
    np.savez(folder / "a_shape.npz", origin=np.array(json.dumps(origin)))
    np.savez(folder / "a_maps.npz", header=np.array(json.dumps(origin)))
    write_png(folder / "a_panel.png", np.zeros((2, 2, 3), np.uint8), text)
    square = np.array([[0.0, 0], [1, 0], [0, 1]])
    triangle = np.array([[0, 1, 2]])
    picture = np.zeros((2, 2, 3), np.uint8)
    mesh = Mesh(np.eye(3), triangle, square, triangle, picture)
    write_mesh(folder / "a_face.obj", mesh, text)
    return sorted(folder.iterdir())


def test_results_belong_to_their_input(tmp_path: Path, scans: list[Source]) -> None:
    files = write_results(tmp_path / "out", scans[0])
    assert len(files) == 7
    for file in files:
        assert scans[0].owns(file) and not scans[1].owns(file)
        assert read_result_mark(file) == scans[0].make_mark("maps", read_result_mark(file).part)


@pytest.mark.parametrize(
    "name", ["a_panel.png", "a_maps.json", "a_maps.npz", "a_face.obj", "a.txt"]
)
def test_a_file_without_a_mark_belongs_to_nobody(
    tmp_path: Path, scans: list[Source], name: str
) -> None:
    (tmp_path / name).write_bytes(b"mine")
    assert not scans[0].owns(tmp_path / name)
    (tmp_path / "folder.png").mkdir()
    assert not scans[0].owns(tmp_path / "folder.png")


def test_a_copy_is_another_input(tmp_path: Path, scans: list[Source]) -> None:
    write_results(tmp_path / "out", scans[0])
    (tmp_path / "c.obj").write_bytes((tmp_path / "a.obj").read_bytes())
    copy = Source.read([tmp_path / "c.obj"])
    assert copy.digest == scans[0].digest
    assert not copy.owns(tmp_path / "out" / "a_maps.json")
    (tmp_path / "a.obj").unlink()
    assert copy.owns(tmp_path / "out" / "a_maps.json")  # the scan was renamed


def test_a_result_stands_for_the_scan_that_it_was_made_from(
    tmp_path: Path, scans: list[Source]
) -> None:
    write_results(tmp_path / "out", scans[0])
    assert Source.read([tmp_path / "out" / "a_maps.npz"]).digest == scans[0].digest
    with pytest.raises(InputError, match=r"absent.npz cannot be read"):
        Source.read([tmp_path / "absent.npz"])


def test_a_model_has_several_inputs_in_order(tmp_path: Path, scans: list[Source]) -> None:
    paths = [scan.paths[0] for scan in scans]
    both, reverse = Source.read(paths), Source.read(paths[::-1])
    (tmp_path / "measures.json").write_text(json.dumps(both.describe("v", "p", tmp_path)))
    assert both.owns(tmp_path / "measures.json")
    for other in (reverse, scans[0]):
        assert not other.owns(tmp_path / "measures.json")


def test_the_folder_of_results_with_fixed_names(tmp_path: Path, scans: list[Source]) -> None:
    names = ["a_maps.npz", "a_panel.png"]
    folder = tmp_path / "out"
    assert choose_folder(None, folder, names, scans[0]) == folder
    write_results(folder, scans[0])
    assert choose_folder(None, folder, names, scans[0]) == folder
    assert choose_folder(folder, folder, names, scans[0]) == folder
    assert choose_folder(None, folder, names, scans[1]) == tmp_path / "out-2"
    with pytest.raises(InputError, match=r"a_maps.npz is there already and was not made from .*b"):
        choose_folder(folder, folder, names, scans[1])
    assert choose_folder(folder, folder, ["b.npz"], scans[1]) == folder


def test_the_verb_of_a_mesh(tmp_path: Path, scans: list[Source]) -> None:
    write_results(tmp_path / "out", scans[0])
    assert find_result_verb(tmp_path / "out" / "a_face.obj") == "maps"
    assert find_result_verb(tmp_path / "a.obj") is None
    assert find_result_verb(tmp_path / "absent.obj") is None
    (tmp_path / "a_face.obj").write_text("v 0 0 0\n")
    assert find_result_verb(tmp_path / "a_face.obj") is None
    np.savez(tmp_path / "a_maps.npz")  # as versions before marks left it
    assert find_result_verb(tmp_path / "a_face.obj") == "maps"
