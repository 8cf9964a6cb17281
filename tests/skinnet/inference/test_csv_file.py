"""Tables grow by whole rows; what is not such a table is refused and stays."""

import csv
import os
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

from skinnet.errors import InputError
from skinnet.inference._csv_file import CsvFile

COLUMNS = ("file", "value")


def read(path: Path) -> list[list[str]]:
    with path.open(newline="", encoding="utf-8-sig") as file:
        return list(csv.reader(file))


def test_a_second_run_appends(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    for value in (1, 2.5):
        CsvFile(path, COLUMNS).append([{"file": "x", "value": value}, {"file": "y"}])
    assert read(path) == [list(COLUMNS), ["x", "1"], ["y", ""], ["x", "2.5"], ["y", ""]]


def test_cells_are_quoted_and_rows_are_lines(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    odd = 'a, "b"\nc\udcff é'
    CsvFile(path, COLUMNS).append([{"file": odd, "value": None}])
    assert read(path)[1] == ['a, "b"\\nc\\udcff é', ""]
    assert path.read_bytes().count(b"\n") == 2


@pytest.mark.parametrize("start", ["\ufefffile,value\r\nx,1\r\n", "file,value\n"])
def test_a_table_that_a_spreadsheet_saved_is_continued(tmp_path: Path, start: str) -> None:
    path = tmp_path / "a.csv"
    path.write_bytes(start.encode())
    CsvFile(path, COLUMNS).append([{"file": "y", "value": 2}])
    assert read(path)[-1] == ["y", "2"] and read(path)[0] == list(COLUMNS)


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (b"file;value\nx;1\n", "has other columns"),
        (b"file,value,more\n", "has other columns"),
        (b"\x89PNG\r\n\x1a\n\0\0", "has other columns"),
        (b"\xff" * 3_000_000, "has other columns"),
        (b"file,value", "ends in a part of a row"),
        (b"file,value\nx,1\ny", "ends in a part of a row"),
    ],
)
def test_other_files_are_refused_and_stay(tmp_path: Path, content: bytes, words: str) -> None:
    path = tmp_path / "a.csv"
    path.write_bytes(content)
    with pytest.raises(InputError, match=words) as error:
        CsvFile(path, COLUMNS)
    assert str(path) in str(error.value) and "--csv" in str(error.value)
    assert path.read_bytes() == content


def test_what_cannot_be_written_is_refused(tmp_path: Path) -> None:
    for path in (tmp_path, tmp_path / "absent" / "a.csv"):
        with pytest.raises(InputError, match="cannot be written"):
            CsvFile(path, COLUMNS)
    assert list(tmp_path.iterdir()) == []


def test_a_full_disk_leaves_no_part_of_a_row(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "a.csv"
    table = CsvFile(path, COLUMNS)
    table.append([{"file": "x", "value": 1}])
    before = path.read_bytes()

    def fail(_: int) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", fail)
    with pytest.raises(InputError, match="No space left"):
        table.append([{"file": "y"}, {"file": "z"}])
    assert path.read_bytes() == before


def test_a_file_that_was_removed_gets_its_heading_again(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    table = CsvFile(path, COLUMNS)
    path.unlink()
    table.append([{"file": "x"}])
    assert read(path) == [list(COLUMNS), ["x", ""]]


def test_several_writers_do_not_mix_rows(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"

    def write(name: str) -> None:
        CsvFile(path, COLUMNS).append({"file": name * 50, "value": i} for i in range(20))

    with ThreadPoolExecutor(4) as pool:
        list(pool.map(write, "abcdefgh"))
    rows = read(path)
    assert rows[0] == list(COLUMNS) and len(rows) == 161
    assert rows.count(list(COLUMNS)) == 1 and all(len(set(name)) == 1 for name, _ in rows[1:])
