"""A folder, a list and Parquet files name photographs; an input without any is refused."""

import os
from pathlib import Path

import pyarrow as pa
import pytest
from batch_files import write_parquet
from flat_decomposer import save

from skinnet.batch._listing import Columns, list_photographs
from skinnet.batch._places import find_place
from skinnet.errors import InputError

USUAL = Columns()


def files(name: object, columns: Columns = USUAL, recursive: bool = False) -> list[str]:
    listing = list_photographs(str(name), columns, recursive)
    return [each.file.rpartition("/")[2] for each in listing.photographs]


def test_a_folder_is_searched_by_the_content_of_its_files(tmp_path: Path) -> None:
    save(tmp_path / "a.jpg"), save(tmp_path / "b", format_="PNG"), save(tmp_path / "below/c.jpg")
    (tmp_path / "notes.md").write_text("no picture")
    assert files(tmp_path) == ["a.jpg", "b"]
    assert files(tmp_path, recursive=True) == ["a.jpg", "b", "c.jpg"]
    notes = list_photographs(str(tmp_path), Columns()).notes
    assert "--recursive" in notes[0] and "notes.md" in notes[1]


def test_a_folder_in_a_store_is_searched_by_endings(tmp_path: Path) -> None:
    folder = find_place(f"memory://{tmp_path}")
    for name in ("a.JPG", "b.txt", ".c.jpg"):
        folder.join(name).write(b"")
    assert files(folder.url) == ["a.JPG"]
    folder.join("below").join("d.txt").write(b"")
    with pytest.raises(InputError, match="holds no photographs"):
        files(folder.join("below").url)


@pytest.mark.parametrize(
    ("name", "text", "column"),
    [
        ("list.txt", "a.jpg\n\nsub/b c.jpg\n", None),
        ("list.csv", "path,age\na.jpg,3\nsub/b c.jpg,4\n", None),
        ("list.tsv", "age\tfile\n3\ta.jpg\n4\tsub/b c.jpg\n", "file"),
    ],
)
def test_a_list_names_paths_from_its_folder(
    name: str, text: str, column: str | None, tmp_path: Path
) -> None:
    save(tmp_path / "a.jpg"), save(tmp_path / "sub/b c.jpg")
    (tmp_path / name).write_text("\ufeff" + text, encoding="utf-8")
    listing = list_photographs(str(tmp_path / name), Columns(path=column))
    assert [each.file for each in listing.photographs] == ["a.jpg", "sub/b c.jpg"]
    first = listing.photographs[0]
    assert first.source == (tmp_path / "a.jpg").as_posix()
    assert first.size == (tmp_path / "a.jpg").stat().st_size


def test_a_file_that_is_listed_twice_is_read_once_and_one_that_is_missing_is_kept(
    tmp_path: Path,
) -> None:
    (tmp_path / "list.txt").write_text("a.jpg\n./a.jpg\nabc://x/y.jpg\n")
    listing = list_photographs(str(tmp_path / "list.txt"), Columns())
    assert "1 photographs are listed more than once" in listing.notes[0]
    faults = [each.fault for each in listing.photographs]
    assert "does not exist" in faults[0] and "Protocol not known" in faults[1]


def test_parquet_holds_bytes_or_paths(tmp_path: Path) -> None:
    data = [save(tmp_path / "a.jpg").read_bytes(), None, b"x"]
    bytes_ = write_parquet(tmp_path / "b.parquet", bytes=data, name=["a", "b", None])
    listing = list_photographs(str(bytes_), Columns())
    assert [each.row for each in listing.photographs] == [0, 1, 2]
    assert len({each.key for each in listing.photographs}) == 3
    paths = write_parquet(tmp_path / "p.parquet", where=["a.jpg", "a.jpg"])
    assert files(paths, Columns(path="where")) == ["a.jpg"]


def test_a_folder_of_parquet_files_is_parquet(tmp_path: Path) -> None:
    for name in ("a", "b"):
        write_parquet(tmp_path / f"{name}.parquet", image=[{"bytes": b"x", "path": name}])
    columns = Columns(bytes="image.bytes", name="image.path")
    assert len(list_photographs(str(tmp_path), columns).photographs) == 2


@pytest.mark.parametrize(
    ("columns", "sentence"),
    [
        (Columns(), r"has no column bytes; its columns are data \(binary\), name \(string\)"),
        (Columns(bytes="name"), "has string in the column name.*--bytes-column"),
        (Columns(bytes="data", name="title"), "has no column title.*--name-column"),
        (Columns(path="where"), "has no column where.*--path-column"),
    ],
)
def test_a_column_that_is_not_there_is_answered_with_those_that_are(
    columns: Columns, sentence: str, tmp_path: Path
) -> None:
    path = write_parquet(tmp_path / "a.parquet", data=[b"x"], name=["a"])
    with pytest.raises(InputError, match=sentence):
        files(path, columns)


def test_what_holds_no_photographs_is_refused(tmp_path: Path) -> None:
    (tmp_path / "empty").mkdir()
    (tmp_path / "a.txt").write_text("\n")
    (tmp_path / "b.csv").write_text("file,age\n")
    (tmp_path / "c.txt").write_bytes(b"Gr\xf6\xdfe.jpg\n")
    (tmp_path / "d.parquet").write_bytes(b"PAR1 damaged")
    write_parquet(tmp_path / "e.parquet", bytes=pa.array([], "binary"), name=pa.array([], "string"))
    for name, sentence in {
        "empty": "The folder .*empty holds no photographs",
        "a.txt": "names no photographs",
        "b.csv": "has no column path; its columns are file, age",
        "c.txt": r"is not text in UTF-8 \(byte 2\)",
        "d.parquet": "cannot be used",
        "e.parquet": "has no rows",
        "absent": "There is no file or folder",
    }.items():
        with pytest.raises(InputError, match=sentence):
            files(tmp_path / name)


def test_columns_of_a_folder_are_refused(tmp_path: Path) -> None:
    save(tmp_path / "a.jpg")
    with pytest.raises(InputError, match="has no columns, but --bytes-column b was given"):
        files(tmp_path, Columns(bytes="b"))


def test_the_key_follows_the_state_of_the_file(tmp_path: Path) -> None:
    path = save(tmp_path / "a.jpg")
    keys = [list_photographs(str(path), Columns()).photographs[0].key]
    keys.append(list_photographs(str(tmp_path), Columns()).photographs[0].key)
    os.utime(path, ns=(0, path.stat().st_mtime_ns + 1000))
    keys.append(list_photographs(str(path), Columns()).photographs[0].key)
    assert keys[0] == keys[1] != keys[2]
