import errno
import os
import subprocess
import sys
from pathlib import Path

import pytest

from skinnet.errors import InputError, _explain_fault
from skinnet.files import _partial, make_folder, write_atomically, write_text, write_together


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


def write_in_a_process(folder: Path, end: str) -> None:
    """Begin to write a file in another process, which ends in some way meanwhile."""
    code = (
        "import os, signal, sys\n"
        "from pathlib import Path\n"
        "from skinnet.files import write_atomically\n"
        f"with write_atomically(Path({str(folder / 'a.txt')!r})) as part:\n"
        "    part.write_text('half')\n"
        f"    {end}\n"
    )
    subprocess.run([sys.executable, "-c", code], capture_output=True, timeout=60)


@pytest.mark.skipif(os.name != "posix", reason="Elsewhere the age of a file decides.")
def test_what_a_killed_process_leaves_is_swept_at_the_next_start(tmp_path: Path) -> None:
    write_in_a_process(tmp_path, "os.kill(os.getpid(), signal.SIGKILL)")
    assert [path.name[:9] for path in tmp_path.iterdir()] == [".skinnet-"]
    _partial.take_removed()
    write_text(tmp_path / "b.txt", "b")
    assert [path.name for path in tmp_path.iterdir()] == ["b.txt"]
    (removed,) = _partial.take_removed()
    assert removed.parent == tmp_path and _partial.take_removed() == []


@pytest.mark.skipif(os.name != "posix", reason="Elsewhere the age of a file decides.")
def test_files_of_running_processes_and_of_the_user_stay(tmp_path: Path) -> None:
    host = _partial._HOST
    kept = [
        f".skinnet-{host}-{os.getppid()}-0123456789ab.part.png",
        ".skinnet-00000000-1-0123456789ab.part.png",  # of another machine, and young
        ".0123456789ab.part.png",  # of an earlier version, and young
        *(".skinnet", f".skinnet-{host}-1-notes.txt", "0123456789ab.part", ".last.ckpt"),
    ]
    for name in kept:
        (tmp_path / name).write_text("")
    old = tmp_path / ".ba9876543210.part.npz"
    old.write_text("")
    os.utime(old, (0, 0))
    write_text(tmp_path / "b.txt", "b")
    assert sorted(path.name for path in tmp_path.iterdir()) == sorted([*kept, "b.txt"])


def test_a_file_that_is_being_written_is_never_swept(tmp_path: Path) -> None:
    (tmp_path / "here").mkdir()
    (tmp_path / "again").symlink_to(tmp_path / "here")
    with write_atomically(tmp_path / "here" / "a.txt") as part:
        part.write_text("a")
        write_text(tmp_path / "again" / "b.txt", "b")  # another name of the folder
    assert sorted(path.name for path in (tmp_path / "here").iterdir()) == ["a.txt", "b.txt"]


@pytest.mark.parametrize("code", [errno.ENOSPC, errno.EROFS, errno.ENAMETOOLONG, errno.EACCES])
def test_errors_of_the_system_have_a_remedy(code: int) -> None:
    said = _explain_fault(OSError(code, os.strerror(code)), "choose another folder")
    remedies = {errno.ENOSPC: "free some space", errno.ENAMETOOLONG: "shorter name"}
    assert remedies.get(code, "choose another folder") in said and os.strerror(code) in said


def test_a_full_disk_leaves_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    write_text(tmp_path / "a.txt", "old")

    def fill(self: Path, text: str, encoding: str) -> None:
        self.write_bytes(text[:2].encode())
        raise OSError(errno.ENOSPC, "No space left on device", str(self))

    monkeypatch.setattr(Path, "write_text", fill)
    with pytest.raises(OSError, match=r"No space left on device: '[^']*/a\.txt'"):
        write_text(tmp_path / "a.txt", "new")
    assert [path.read_bytes() for path in tmp_path.iterdir()] == [b"old"]


def test_a_disk_that_refuses_removing_too_hides_no_error(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(path: object, *_: object, **__: object) -> None:
        raise OSError(errno.EROFS, "Read-only file system", str(path))

    for name in ("replace", "link", "unlink"):
        monkeypatch.setattr(os, name, refuse)
    with pytest.raises(OSError, match=r"Read-only file system: '[^']*/a\.txt'"):
        write_text(tmp_path / "a.txt", "new")
