"""OBJ files: vertices in their order, statements with their lines."""

from pathlib import Path

import pytest

from skinnet.errors import InputError
from skinnet.mesh._obj import read_obj, read_obj_positions


def test_positions_are_in_the_order_of_the_lines(tmp_path: Path) -> None:
    path = tmp_path / "points.obj"
    path.write_text("v 1 2 3\nvn 0 0 1\nvt 0 0\nv\t4 5 6 0.5 0.5 0.5\n")
    assert read_obj_positions(path).tolist() == [[1, 2, 3], [4, 5, 6]]
    path.write_text("# nothing\n")
    assert read_obj_positions(path).shape == (0, 3)
    path.write_text("v 1 2 x\n")
    with pytest.raises(InputError, match=r"points\.obj cannot be read as a mesh: line 1 has 'x'"):
        read_obj_positions(path)


def test_triangles_have_the_material_before_them(tmp_path: Path) -> None:
    path = tmp_path / "a.obj"
    path.write_text(
        "mtllib a.mtl b.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nusemtl my skin \nf 1 2 3\n"
        "usemtl eye\nusemtl skin\nf 1 2 3\n"
    )
    file = read_obj(path)
    assert file.material.tolist() == [-1, 0, 2]
    assert [each.rest for each in file.materials] == [b"my skin", b"eye", b"skin"]
    assert [(each.line, each.rest) for each in file.libraries] == [(0, b"a.mtl b.mtl")]
