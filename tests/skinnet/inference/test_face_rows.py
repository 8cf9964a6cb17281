"""Rows of the table of faces."""

import csv
import hashlib
import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from skinnet import Decomposer, Decomposition
from skinnet.images.faces._face_regions import REGION_NAMES
from skinnet.inference._face_rows import COLUMNS, FaceTable


def summarise(face: Decomposition) -> dict[str, Any]:
    about = {"file": "a.png", "input": {"path": "../a.png", "sha256": "0f"}}
    return json.loads(json.dumps(about | face.summary(), allow_nan=False))


def read(path: Path) -> list[dict[str, str]]:
    with path.open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


@pytest.fixture
def face(decomposition: Decomposition) -> Decomposition:
    return replace(decomposition, model=decomposition.model | {"optics": "measured"})


def test_columns_are_stable() -> None:
    assert len(COLUMNS) == len(set(COLUMNS)) == 280
    # Files of users with other columns are refused: change them in a new version alone.
    assert hashlib.sha256(",".join(COLUMNS).encode()).hexdigest()[:16] == "4a12b4b3b7fd291f"
    assert COLUMNS[:9] == (
        *("file", "face", "reason", "faces_found", "skin_share", "capture_known"),
        *("melanin", "melanin_low", "melanin_high"),
    )
    scales = ("l_star", "a_star", "b_star", "typology_angle", "melanin_index", "erythema_index")
    for start in ("", *(f"{region}_" for region in REGION_NAMES)):
        for name in (*scales, "hemoglobin", "monk_tone"):
            assert {f"{start}{name}{end}" for end in ("", "_low", "_high")} <= set(COLUMNS)
        assert {f"{start}monk_delta_e", f"{start}typology_group"} <= set(COLUMNS)
    assert COLUMNS[-5:] == ("sha256", "optics", "model_version", "version", "notes")


def test_a_row_holds_what_the_summary_holds(face: Decomposition, tmp_path: Path) -> None:
    table, summary = FaceTable(tmp_path / "a.csv"), summarise(face)
    table.add([summary, summary])
    row, again = read(tmp_path / "a.csv")
    assert row == again and table.notes == []
    assert (row["file"], row["face"], row["reason"], row["faces_found"]) == ("a.png", "1", "", "1")
    assert float(row["melanin"]) == summary["pigments"]["melanin"]["mean"]
    angle = summary["indices"]["typology_angle"]
    ends = float(row["typology_angle_low"]), float(row["typology_angle_high"])
    assert float(row["typology_angle"]) == angle["value"] and list(ends) == angle["interval"]
    assert row["typology_group"] == summary["indices"]["typology_group"]
    nose = summary["regions"]["nose"]
    assert float(row["nose_share"]) == nose["share"]
    assert float(row["nose_hemoglobin"]) == nose["hemoglobin"]["mean"]
    assert int(row["nose_monk_tone"]) == nose["indices"]["monk_tone"]["value"]
    assert row["sha256"] == "0f" and row["optics"] == "measured"


def test_other_presets_have_empty_indices_and_a_note(
    decomposition: Decomposition, tmp_path: Path
) -> None:
    table = FaceTable(tmp_path / "a.csv")
    table.add([summarise(decomposition)])
    (row,) = read(tmp_path / "a.csv")
    assert row["typology_angle"] == row["nose_l_star"] == "" and row["melanin"] != ""
    (note,) = table.notes
    assert "preset paper" in note and "columns are empty" in note


def test_a_face_without_skin_has_empty_numbers(
    skinless_file: Path, astronaut: Any, tmp_path: Path
) -> None:
    FaceTable(tmp_path / "a.csv").add([summarise(Decomposer(skinless_file)(astronaut))])
    (row,) = read(tmp_path / "a.csv")
    assert row["melanin"] == row["melanin_low"] == "" and float(row["skin_share"]) == 0


def test_a_failure_is_a_row_with_its_reason(tmp_path: Path) -> None:
    FaceTable(tmp_path / "a.csv").add_failure("b.png", "b.png has no face.")
    (row,) = read(tmp_path / "a.csv")
    assert {name: cell for name, cell in row.items() if cell} == {
        "file": "b.png",
        "reason": "b.png has no face.",
    }


def test_without_a_file_nothing_is_written(tmp_path: Path, monkeypatch: Any) -> None:
    monkeypatch.chdir(tmp_path)
    table = FaceTable(None)
    table.add([{}])
    table.add_failure("a", "b")
    assert list(tmp_path.iterdir()) == [] and table.notes == []
