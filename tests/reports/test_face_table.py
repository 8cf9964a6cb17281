"""`predict --csv`: one row for each face and each failure, appended whole."""

import csv
from pathlib import Path

import pytest
from flat_decomposer import SKIN, WALL, names, run, save

from skinnet.inference._face_rows import COLUMNS

__all__ = ["run"]


def read(path: Path) -> list[dict[str, str]]:
    with path.open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def test_faces_and_failures_are_rows(run, tmp_path: Path) -> None:
    save(tmp_path / "in" / "a.png")
    save(tmp_path / "in" / "b.png", WALL)
    (tmp_path / "in" / "c.png").write_bytes(b"\x89PNG\r\n\x1a\nbroken")
    table = tmp_path / "faces.csv"
    code, _, said = run("predict", tmp_path / "in", "--csv", table, "--faces", "all")
    assert code == 2
    rows = {(Path(row["file"]).name, row["face"]): row for row in read(table)}
    assert list(rows) == [
        *(("a.png", str(face)) for face in (1, 2, 3)),
        ("b.png", ""),
        ("c.png", ""),
    ]
    assert all(row["melanin"] == "0.2" for (name, _), row in rows.items() if name == "a.png")
    for name in ("b.png", "c.png"):
        reason = rows[name, ""]["reason"]
        assert name in reason and f"skinnet: {reason}" in said
    assert rows["a.png", "1"]["reason"] == ""


def test_a_second_run_appends(run, tmp_path: Path) -> None:
    photo, table = save(tmp_path / "a.png"), tmp_path / "faces.csv"
    assert run("predict", photo, "--csv", table)[0] == 0
    first = table.read_bytes()
    assert run("predict", photo, "--csv", table)[0] == 0
    assert table.read_bytes().startswith(first) and len(read(table)) == 2


def test_the_table_may_lie_among_the_results_and_standard_input_has_a_name(
    run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    photo, folder = save(tmp_path / "a.png"), tmp_path / "out"
    folder.mkdir()
    assert run("predict", photo, "-o", folder, "--csv", folder / "faces.csv")[0] == 0
    assert "faces.csv" in names(folder)
    monkeypatch.setattr("sys.stdin", None)
    assert run("predict", "-", "-o", folder, "--csv", folder / "faces.csv")[0] == 2
    assert [row["file"] for row in read(folder / "faces.csv")] == [str(photo), "standard input"]


@pytest.mark.parametrize("content", ["file,melanin\na.png,0.1\n", f"{','.join(COLUMNS)}\nhalf"])
def test_another_table_is_refused_before_anything_is_read(
    run, tmp_path: Path, content: str
) -> None:
    photo, table = save(tmp_path / "a.png", SKIN), tmp_path / "faces.csv"
    table.write_text(content)
    code, out, said = run("predict", photo, "--csv", table)
    assert code == 2 and out == "" and str(table) in said and "Traceback" not in said
    assert table.read_text() == content and names(tmp_path) == ["a.png", "faces.csv"]


def test_results_that_cannot_be_written_are_rows(run, tmp_path: Path) -> None:
    photo, table = save(tmp_path / "a.png"), tmp_path / "faces.csv"
    (tmp_path / "out").write_text("a file")
    assert run("predict", photo, "-o", tmp_path / "out", "--csv", table)[0] == 2
    (row,) = read(table)
    assert row["melanin"] == "" and "cannot be" in row["reason"]
