"""A file of spectra is read as it is, or refused with a sentence."""

import sys
from pathlib import Path

import pytest

from benchmarks import spectra
from benchmarks.report import main
from benchmarks.spectra_file import COLUMNS, read_spectra
from skinnet.errors import InputError

ROW = ["7", "CA", *["0.3"] * 31, "", "0"]


def write(path: Path, *rows: list[str]) -> Path:
    path.write_text("\n".join(",".join(row) for row in rows) + "\n", encoding="utf-8")
    return path


def test_empty_cells_and_zeros_are_missing(tmp_path: Path) -> None:
    found = read_spectra(write(tmp_path / "a.csv", ["# source"], COLUMNS, ROW, ROW))
    assert found.shape == (2, 33) and (found[:, :31] == 0.3).all()
    assert found[:, 31:].isnan().all()


@pytest.mark.parametrize(
    ("rows", "sentence"),
    [
        ([ROW], "columns"),
        ([COLUMNS], "columns"),
        ([["nm", *COLUMNS[1:]], ROW], "columns"),
        ([COLUMNS, ROW[:-1]], "34 cells"),
        ([COLUMNS, ["7", "CA", *["30.1"] * 33]], "percent"),
        ([COLUMNS, ["7", "CA", "x", *["0.3"] * 32]], "'x'"),
        ([COLUMNS, ["7", "CA", "nan", *["0.3"] * 32]], "'nan'"),
        ([COLUMNS, ["7", "CA", "0", *["0.3"] * 32]], "lacks 400 nm"),
        ([COLUMNS, ["7", "CA", *["0.3"] * 12, *["0"] * 21]], "lacks 400 nm"),
    ],
)
def test_other_files_are_refused(tmp_path: Path, rows: list[list[str]], sentence: str) -> None:
    with pytest.raises(InputError, match=sentence):
        read_spectra(write(tmp_path / "a.csv", *rows))


def test_an_absent_file_ends_with_a_sentence(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(sys, "argv", ["benchmark", "--issa", str(tmp_path / "absent.csv")])
    with pytest.raises(SystemExit) as stopped:
        main(spectra.measure, "", paths={"issa": "", "peers": ""})
    assert stopped.value.code == 2 and "absent.csv" in capsys.readouterr().err
