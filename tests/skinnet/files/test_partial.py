import os
from pathlib import Path

import pytest

from skinnet.errors import InputError
from skinnet.files import make_folder, write_atomically, write_text, write_together


def test_a_failed_write_leaves_what_was_there(tmp_path: Path) -> None:
    path = tmp_path / "a.txt"
    write_text(path, "old")

    def fail() -> None:
        with write_atomically(path) as part:
            part.write_text("ne")
            raise RuntimeError

    with pytest.raises(RuntimeError):
        fail()
    assert [file.read_text() for file in tmp_path.iterdir()] == ["old"]


def write_two(folder: Path, first: str, second: str, content: str | None) -> None:
    with write_together() as temporary:
        temporary(folder / first).write_text("1")
        path = temporary(folder / second)
        if content is not None:
            path.write_text(content)


def test_files_are_written_together_or_not_at_all(tmp_path: Path) -> None:
    (tmp_path / "b").mkdir()
    with pytest.raises(InputError, match="b is a folder"):
        write_two(tmp_path, "a", "b", "2")
    with pytest.raises(FileNotFoundError):  # the second file is never written
        write_two(tmp_path, "c", "d", None)
    assert [file.name for file in tmp_path.iterdir()] == ["b"]
    write_two(tmp_path, "e", "f", "2")
    assert sorted(file.name for file in tmp_path.iterdir()) == ["b", "e", "f"]


def test_a_failed_rename_leaves_all_older_files(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in ("a", "b"):
        (tmp_path / name).write_text("old")
    replace = os.replace

    def refuse(source: Path, target: Path) -> None:
        if target.name == "b" and source.suffix != ".old" and ".part" in source.name:
            raise PermissionError(13, "Permission denied")  # as for a file that a viewer holds open
        replace(source, target)

    monkeypatch.setattr(os, "replace", refuse)
    with pytest.raises(PermissionError):
        write_two(tmp_path, "a", "b", "new")
    assert {path.name: path.read_text() for path in tmp_path.iterdir()} == {"a": "old", "b": "old"}
    monkeypatch.setattr(os, "replace", replace)
    write_two(tmp_path, "a", "b", "new")
    assert {path.name: path.read_text() for path in tmp_path.iterdir()} == {"a": "1", "b": "new"}


def test_a_folder_that_cannot_be_made_is_named(tmp_path: Path) -> None:
    assert make_folder(tmp_path / "a" / "b", "choose another").is_dir()
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match=r"file/b cannot be made \(Not a directory\); choose"):
        make_folder(tmp_path / "file" / "b", "choose another")
