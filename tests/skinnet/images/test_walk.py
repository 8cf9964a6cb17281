import os
from pathlib import Path

import pytest
from flat_decomposer import save

from skinnet.errors import InputError
from skinnet.images import _found_files
from skinnet.images._found_files import count_below, escape_existing, get_identity, look_at
from skinnet.images._kind import PICTURE
from skinnet.images._mark import EDITED, Mark
from skinnet.images._walk import RESULT, SECOND_NAME, check_mark, find_one, walk


def list_names(*inputs: Path, recursive: bool = False) -> list[str]:
    found = walk([str(each) for each in inputs], recursive)
    return [Path(each.path).name for each in found.pictures if each.error is None]


def test_the_order_is_that_of_names_in_every_folder(tmp_path: Path) -> None:
    for name in ("b.png", "a/z.png", "a.png", "c/a.png", "B.png", "a-b.png"):
        save(tmp_path / name)
    assert list_names(tmp_path) == ["B.png", "a-b.png", "a.png", "b.png"]
    found = walk([str(tmp_path)], recursive=True).pictures
    assert [each.path for each in found] == [
        str(tmp_path / name)
        for name in ("B.png", "a/z.png", "a-b.png", "a.png", "b.png", "c/a.png")
    ]


def test_inputs_keep_their_order_and_spelling(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    save(Path("g/a.png"))
    save(Path("b.png"))
    found = walk(["./b.png", "-", "g", "absent.png", "-"])
    assert [each.path for each in found.pictures] == ["./b.png", "-", "g/a.png", "absent.png"]
    assert [tuple(each) for each in found.passed_over] == [("-", SECOND_NAME)]


def test_what_is_passed_over_is_described(tmp_path: Path) -> None:
    for name in "abcde":
        (tmp_path / f"{name}.pdf").write_bytes(b"%PDF-1.4")
    (tmp_path / "f.mp4").write_bytes(b"\0\0\0\x10ftypisom\0\0\0\0")
    found = walk([str(tmp_path)])
    assert found.describe_passed_over() == (
        "5 PDF files (a.pdf, b.pdf, c.pdf and 2 more); 1 video (f.mp4)"
    )
    assert walk(["absent"]).describe_passed_over() == ""


def test_pictures_in_subfolders_are_counted_up_to_a_limit(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for number in range(6):
        save(tmp_path / str(number % 2) / f"{number}.png")
    assert count_below([tmp_path]) == (6, 2, True)
    monkeypatch.setattr(_found_files, "_MOST_COUNTED", 4)
    assert count_below([tmp_path]) == (4, 2, False)
    (note,) = walk([str(tmp_path), str(save(tmp_path / "a.png"))]).notes
    assert "further pictures, at least 4 in 2 subfolders" in note


def test_two_names_of_a_file_are_one(tmp_path: Path) -> None:
    first = save(tmp_path / "a.png")
    os.link(first, tmp_path / "b.png")
    (tmp_path / "c.png").symlink_to("a.png")
    copy = tmp_path / "d.png"
    copy.write_bytes(first.read_bytes())
    names = [get_identity(tmp_path / name) for name in ("a.png", "b.png", "c.png")]
    assert len(set(names)) == 1 and get_identity(copy) not in names
    assert list_names(tmp_path) == ["a.png", "d.png"]


def test_a_file_system_without_numbers_of_files_has_paths(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    save(tmp_path / "a.png")
    (tmp_path / "b.png").symlink_to("a.png")
    stat = os.stat

    def forget(path: str | Path, **options: object) -> os.stat_result:
        values = list(stat(path, **options))  # type: ignore[call-overload]
        values[1] = 0
        return os.stat_result(values)

    monkeypatch.setattr(os, "stat", forget)
    assert list_names(tmp_path) == ["a.png"]


def test_files_that_may_not_be_opened_are_left_to_the_reader_or_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    photo, text = save(tmp_path / "a.png"), tmp_path / "b.txt"
    text.write_text("text")

    def refuse(*_: object) -> None:
        raise PermissionError(13, "Permission denied")

    assert look_at(str(photo)) is PICTURE
    monkeypatch.setattr("builtins.open", refuse)
    assert look_at(str(photo)) is None
    kind = look_at(str(text))
    assert kind is not None and kind.one == "a file that cannot be opened (permission denied)"
    assert list_names(tmp_path) == ["a.png"]


@pytest.mark.parametrize(
    ("pattern", "expected"),
    [
        ("g[1]/*.png", "g[[]1]/*.png"),
        ("g*/*.png", "g*/*.png"),
        ("absent[1]/*.png", "absent[1]/*.png"),
        ("*", "*"),
    ],
)
def test_folders_that_exist_are_taken_as_they_are(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, pattern: str, expected: str
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("g[1]").mkdir()
    assert escape_existing(pattern) == expected
    assert escape_existing(str(tmp_path / pattern)) == str(tmp_path / expected)


def test_one_picture_is_found(tmp_path: Path) -> None:
    photo = save(tmp_path / "a.png")
    assert find_one(str(photo)).path == str(photo)
    assert find_one(str(tmp_path / "*.png")).path == str(photo)
    assert find_one("-").path == "-"
    assert find_one(str(tmp_path)).path == str(tmp_path)  # the reader says that it is a folder
    for wrong in ("", str(tmp_path / "*.jpg")):
        with pytest.raises(InputError):
            find_one(wrong)


def test_only_edits_are_photographs_among_results(tmp_path: Path) -> None:
    assert check_mark(None, "a") == ()
    (note,) = check_mark(Mark("edit", EDITED), "a.png")
    assert note.startswith("a.png was edited by skinnet")
    with pytest.raises(InputError, match=r"a is a result of skinnet \(panel\)"):
        check_mark(Mark("predict", "panel"), "a")


def test_a_pattern_of_results_alone_is_a_sentence(tmp_path: Path) -> None:
    exif_free = save(tmp_path / "a_edited.bmp")
    with exif_free.open("ab") as file:
        file.write(f"\n{Mark('edit', EDITED)}\n".encode())
    found = walk([str(tmp_path / "*.bmp")])
    assert [kind for _, kind in found.passed_over] == [RESULT]
    (only,) = found.pictures
    assert only.error is not None and "No photograph matches the pattern" in str(only.error)
