"""The picture beside a mesh that names none: by name, never by chance."""

from pathlib import Path

import pytest
from PIL import Image

from skinnet.mesh._texture_beside import find_texture_beside, is_picture


def save(path: Path) -> Path:
    Image.new("RGB", (4, 3), (200, 120, 90)).save(path)
    return path


def test_it_has_the_meshs_name_or_is_the_only_one_and_called_colour(tmp_path: Path) -> None:
    mesh = tmp_path / "head.obj"
    mesh.write_text("")
    assert find_texture_beside(mesh).path is None
    albedo = save(tmp_path / "albedo.png")
    assert find_texture_beside(mesh).path == albedo
    save(tmp_path / "normals.png")
    assert find_texture_beside(mesh).path is None
    named = save(tmp_path / "head.png")
    found = find_texture_beside(mesh)
    assert found.path == named and "head.png is taken" in found.note


@pytest.mark.parametrize(
    ("name", "taken"),
    [
        ("HEAD.JPG", True),
        ("head_albedo.png", True),
        ("head-BaseColor.png", True),
        ("head.diffuse.tif", True),
        ("TX_Face_Color.png", True),
        ("head_normal.png", False),
        ("head_colour_normal.png", False),
        ("headlight_albedo_mask.png", False),
        ("IMG_0001.jpg", False),
        ("preview.png", False),
        ("head_ao.png", False),
    ],
)
def test_names_decide(tmp_path: Path, name: str, taken: bool) -> None:
    (tmp_path / "head.obj").write_text("")
    picture = save(tmp_path / name)
    found = find_texture_beside(tmp_path / "head.obj")
    assert found.path == (picture if taken else None)
    assert name in found.note


def test_a_name_of_colour_is_not_enough_beside_another_mesh(tmp_path: Path) -> None:
    for name in ("a.obj", "b.obj"):
        (tmp_path / name).write_text("")
    save(tmp_path / "albedo.png")
    assert find_texture_beside(tmp_path / "a.obj").path is None


def test_pictures_are_known_by_their_content(tmp_path: Path) -> None:
    save(tmp_path / "head.png").rename(tmp_path / "head.texture")
    (tmp_path / "head.txt").write_text("no picture")
    (tmp_path / "head.obj").write_text("")
    assert find_texture_beside(tmp_path / "head.obj").path == tmp_path / "head.texture"
    assert not is_picture(tmp_path / "head.txt")
