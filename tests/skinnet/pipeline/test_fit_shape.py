"""`skinnet fit-shape`."""

import json
import shutil
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from pipeline_scans import FAST, write_scan

from skinnet.cli import main
from skinnet.mesh.mesh_file import read_mesh
from skinnet.pipeline._fit_archive import load_fit

pytestmark = pytest.mark.slow

Refused = Callable[..., str]


def test_a_scan_is_fitted_and_its_files_are_there(
    scans: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["fit-shape", str(scans / "a.obj"), "-o", str(tmp_path), *FAST]) == 0
    said = capsys.readouterr()
    assert "mm RMS over the nearest" in said.out
    assert "500 vertices, 10 modes" in said.err
    found, scan = load_fit(tmp_path / "a_shape.npz"), read_mesh(scans / "a.obj")
    assert found.rms < 0.3
    assert np.linalg.norm(found.vertices - scan.vertices, axis=1).mean() < 2
    record = json.loads((tmp_path / "a_shape.json").read_text())
    assert record["millimetres"] == pytest.approx(1, rel=0.02)
    assert record["stages"][0]["vertices"] == 500
    assert (tmp_path / "a_shape.png").stat().st_size > 10_000
    assert read_mesh(tmp_path / "a_shape.obj").vertices.shape == found.vertices.shape


@pytest.mark.parametrize("units", [0.001, 0.1])
def test_a_scan_in_metres_or_centimetres_is_the_same(tmp_path: Path, units: float) -> None:
    write_scan(tmp_path / "a.obj", 1, units)
    assert main(["fit-shape", str(tmp_path / "a.obj"), *FAST]) == 0
    found = load_fit(tmp_path / "skinmaps" / "a_shape.npz")
    assert found.millimetres == pytest.approx(1 / units, rel=0.02)
    assert found.rms < 0.3


def test_a_finished_fit_is_kept_and_another_setting_is_not(
    scans: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    command = ["fit-shape", str(scans / "a.obj"), "-o", str(tmp_path), *FAST]
    assert main(command) == 0
    first = (tmp_path / "a_shape.npz").stat().st_mtime_ns
    assert main(command) == 0
    assert "is there already and is kept" in capsys.readouterr().err
    assert (tmp_path / "a_shape.npz").stat().st_mtime_ns == first
    assert main([*command, "--fit.kept=0.9"]) == 0
    assert (tmp_path / "a_shape.npz").stat().st_mtime_ns != first


def test_a_bad_scan_does_not_stop_the_others(scans: Path, tmp_path: Path, refused: Refused) -> None:
    (tmp_path / "broken.obj").write_text("v 1 2 nonsense")
    said = refused("fit-shape", tmp_path / "broken.obj", scans / "b.obj", "-o", tmp_path, *FAST)
    assert "broken.obj" in said
    assert (tmp_path / "b_shape.npz").is_file()
    assert not list(tmp_path.glob("broken_*"))


def test_mirrored_landmarks_are_refused(scans: Path, tmp_path: Path, refused: Refused) -> None:
    shutil.copy(scans / "a.obj", tmp_path)
    text = (scans / "a_landmarks.csv").read_text()
    swapped = text.replace("left", "LEFT").replace("right", "left").replace("LEFT", "right")
    (tmp_path / "a_landmarks.csv").write_text(swapped)
    assert "appear mirrored; swap left and right" in refused("fit-shape", tmp_path / "a.obj")


def test_too_few_landmarks_are_refused(scans: Path, tmp_path: Path, refused: Refused) -> None:
    shutil.copy(scans / "a.obj", tmp_path)
    lines = (scans / "a_landmarks.csv").read_text().splitlines()
    (tmp_path / "a_landmarks.csv").write_text("\n".join(lines[:3]))
    said = refused("fit-shape", tmp_path / "a.obj")
    assert "a_landmarks.csv" in said and "missing are" in said


def test_a_scan_that_is_no_face_is_refused(tmp_path: Path, refused: Refused) -> None:
    import trimesh

    trimesh.creation.icosphere(subdivisions=3, radius=90).export(tmp_path / "ball.ply")
    assert "ball.ply from the front" in refused("fit-shape", tmp_path / "ball.ply")
    assert not list((tmp_path / "skinmaps").glob("ball_*"))


def test_one_file_of_landmarks_for_two_scans_is_refused(scans: Path, refused: Refused) -> None:
    said = refused(
        "fit-shape", scans / "a.obj", scans / "b.obj", "--landmarks", scans / "a_landmarks.csv"
    )
    assert "one file of landmarks for 2 scans" in said


def test_two_scans_of_one_name_are_refused(scans: Path, tmp_path: Path, refused: Refused) -> None:
    shutil.copy(scans / "a.obj", tmp_path)
    said = refused("fit-shape", scans / "a.obj", tmp_path / "a.obj", "-o", tmp_path)
    assert "would write the same files" in said


@pytest.mark.parametrize(
    ("option", "words"),
    [
        ("--fit.kept=80", "kept is a share of the vertices"),
        ("--fit.keep=0.8", "keep"),
        ("--config=absent.yaml", "absent.yaml"),
        ("--shape=absent.npz", "There is no shape model absent.npz"),
    ],
)
def test_a_bad_option_is_named(scans: Path, refused: Refused, option: str, words: str) -> None:
    assert words in refused("fit-shape", scans / "a.obj", option)
