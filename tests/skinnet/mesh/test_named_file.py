"""Named files: the one that is meant, or none."""

from pathlib import Path

import pytest

from skinnet.mesh._named_file import find_named_file


@pytest.mark.parametrize(
    ("name", "file"),
    [
        ("skin.png", "skin.png"),
        ("a%20b.png", "a b.png"),
        ("a b.png", "a b.png"),
        ("maps\\skin.png", "maps/skin.png"),
        ("MAPS/Skin.PNG", "maps/skin.png"),
        ("./maps//skin.png", "maps/skin.png"),
        ("maps/../skin.png", "skin.png"),
        ("skin.png?width=2#a", "skin.png"),
        ("e\u0301.png", "\u00e9.png"),
        ("\u00e9.png", "e\u0301.png"),
        ("50%.png", "50%.png"),
    ],
)
def test_spellings(tmp_path: Path, name: str, file: str) -> None:
    (tmp_path / "maps").mkdir()
    assert find_named_file(tmp_path, name) is None
    (tmp_path / file).write_text("")
    found = find_named_file(tmp_path, name)
    assert found is not None and found.samefile(tmp_path / file)


def test_the_exact_name_comes_first(tmp_path: Path) -> None:
    for name in ("a%20b.png", "a b.png", "C.png", "c.png"):
        (tmp_path / name).write_text("")
    assert find_named_file(tmp_path, "a%20b.png") == tmp_path / "a%20b.png"
    assert find_named_file(tmp_path, "c.png") == tmp_path / "c.png"


def test_two_files_that_differ_in_case_are_not_chosen_from(tmp_path: Path) -> None:
    for name in ("skin.png", "Skin.png"):
        (tmp_path / name).write_text("")
    if len(list(tmp_path.iterdir())) == 2:
        assert find_named_file(tmp_path, "SKIN.png") is None


@pytest.mark.parametrize("name", ["", ".", "..", "none.png", "a\0b", "x" * 5000, "maps"])
def test_what_is_no_file_is_not_found(tmp_path: Path, name: str) -> None:
    (tmp_path / "maps").mkdir()
    assert find_named_file(tmp_path, name) is None


def test_absolute_names(tmp_path: Path) -> None:
    (tmp_path / "Skin.png").write_text("")
    assert find_named_file(tmp_path, str(tmp_path / "Skin.png")) == tmp_path / "Skin.png"
    assert find_named_file(tmp_path, f"file://{tmp_path}/Skin.png") == tmp_path / "Skin.png"
    assert find_named_file(tmp_path, str(tmp_path / "skin.PNG")) == tmp_path / "Skin.png"


@pytest.mark.parametrize("name", ["../skin.png", "{}/skin.png", "file://{}/SKIN.png", "a/../../a"])
def test_no_path_leads_out_of_the_folder(tmp_path: Path, name: str) -> None:
    (tmp_path / "skin.png").write_text("")
    folder = tmp_path / "mesh"
    folder.mkdir()
    assert find_named_file(folder, name.format(tmp_path)) is None
    assert find_named_file(folder, "../skin.png", tmp_path) is not None
