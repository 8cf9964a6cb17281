"""The .npz of ICT-FaceKit from a checkout of its form."""

import json
from pathlib import Path

import numpy as np
import pytest

from tools import ict_facekit

MESH = """mtllib a.mtl
{vertices}
vt 0 0
vt 1 0
vt 1 1
vt 0 1
usemtl M_Face
f 1/1 2/2 3/3 4/4
usemtl M_Teeth
f 1/1 2/2 3/3
"""
CORNERS = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0.0]])


@pytest.fixture
def checkout(tmp_path: Path) -> Path:
    folder = tmp_path / "ICT-FaceKit" / "FaceXModel"
    folder.mkdir(parents=True)
    for number, name in enumerate(("generic_neutral_mesh", "identity000", "jawOpen")):
        lines = [" ".join(["v", *map(str, corner)]) for corner in CORNERS + number]
        (folder / f"{name}.obj").write_text(MESH.format(vertices="\n".join(lines)))
    listed = {"expressions": ["jawOpen"], "idx_to_landmark_verts": [3, 1]}
    (folder / "vertex_indices.json").write_text(json.dumps(listed))
    return folder.parent


def test_all_arrays_are_there(checkout: Path, tmp_path: Path) -> None:
    path = tmp_path / "ict.npz"
    assert ict_facekit.main([str(checkout), "-o", str(path)]) == 0
    with np.load(path) as arrays:
        assert arrays["tris"].tolist() == [[0, 1, 2], [0, 2, 3], [0, 1, 2]]
        assert arrays["tri_material"].tolist() == [0, 0, 1]
        assert arrays["material_names"].tolist() == ["M_Face", "M_Teeth"]
        assert (arrays["id_modes"] == 1).all() and (arrays["expr_modes"] == 2).all()
        assert arrays["uv"].shape == (4, 2) and arrays["landmarks68"].tolist() == [3, 1]


def test_what_cannot_be_used_is_said(
    checkout: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "ict.npz"
    (checkout / "FaceXModel" / "jawOpen.obj").write_text("v 0 0 0\n")
    assert ict_facekit.main([str(checkout), "-o", str(path)]) == 2
    assert "jawOpen.obj has 1 vertices" in capsys.readouterr().err
    assert ict_facekit.main([str(tmp_path), "-o", str(path)]) == 2
    assert "has no generic_neutral_mesh.obj" in capsys.readouterr().err
    path.write_bytes(b"mine")
    assert ict_facekit.main([str(checkout), "-o", str(path)]) == 2
    assert path.read_bytes() == b"mine"
