"""Parts of mesh files: one for each material, in the file's frame."""

from pathlib import Path

import numpy as np
import pytest
import trimesh

from skinnet.errors import InputError
from skinnet.mesh._content import read_content
from skinnet.mesh._mesh_parts import (
    MESH_SUFFIXES,
    MeshGeometry,
    concatenate,
)


def test_each_material_is_a_part_with_its_colour(tmp_path: Path) -> None:
    path = tmp_path / "two.obj"
    path.write_text(
        "mtllib two.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\n"
        "usemtl a\nf 1/1 2/2 3/3\nusemtl b\nf 1 3 4\n"
    )
    (tmp_path / "two.mtl").write_text("newmtl a\nKd 1 0 0\nnewmtl b\nKd 0 0 1\n")
    other, one = sorted(read_content(path).parts, key=lambda part: int(part.colour[0]))
    assert one.uv is not None and other.uv is None
    assert one.texture is None and other.texture is None
    assert one.colour.tolist() == [255, 0, 0] and other.colour.tolist() == [0, 0, 255]


def test_parts_are_in_the_frame_of_the_scene(tmp_path: Path) -> None:
    scene = trimesh.Scene()
    move = trimesh.transformations.translation_matrix([5, 0, 0])
    scene.add_geometry(trimesh.creation.box(), transform=move)
    scene.export(tmp_path / "moved.glb")
    (part,) = read_content(tmp_path / "moved.glb").parts
    assert np.allclose(part.geometry.vertices.mean(0), [5, 0, 0])


def test_concatenated_triangles_keep_their_vertices() -> None:
    one = MeshGeometry(np.eye(3), np.array([[0, 1, 2]]))
    both = concatenate([one, MeshGeometry(2 * np.eye(3), np.array([[2, 1, 0]]))])
    assert both.triangles.tolist() == [[0, 1, 2], [5, 4, 3]]
    assert np.array_equal(both.vertices, np.concatenate([np.eye(3), 2 * np.eye(3)]))


def test_another_kind_of_file_is_refused_with_the_kinds_that_are_read(tmp_path: Path) -> None:
    (tmp_path / "scan.fbx").write_text("")
    with pytest.raises(InputError, match=", ".join(MESH_SUFFIXES)):
        read_content(tmp_path / "scan.fbx")
