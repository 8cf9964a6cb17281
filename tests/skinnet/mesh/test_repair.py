"""What is wrong with a mesh is repaired with a note, or refused in a sentence."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import trimesh
from small_meshes import dome, moebius_strip
from toned_pictures import TONES, make_colour

from skinnet.errors import InputError
from skinnet.mesh._orientation import is_inside_out
from skinnet.mesh.mesh import Mesh
from skinnet.mesh.mesh_file import read_mesh
from skinnet.mesh.repair import repair_mesh


def join_meshes(one: Mesh, *others: Mesh) -> Mesh:
    """Meshes side by side in one, without textures."""
    meshes = (one, *others)
    starts = np.cumsum([0] + [len(mesh.vertices) for mesh in meshes[:-1]])
    return Mesh(
        np.concatenate([mesh.vertices for mesh in meshes]),
        np.concatenate([m.triangles + start for m, start in zip(meshes, starts, strict=True)]),
        name=one.name,
    )


def move(mesh: Mesh, by: float, scale: float = 1.0) -> Mesh:
    return replace(mesh, vertices=mesh.vertices * scale + by)


def replace_x(mesh: Mesh, **at: float) -> Mesh:
    vertices = mesh.vertices.copy()
    for name, value in at.items():
        vertices[int(name[1:]), 0] = value
    return replace(mesh, vertices=vertices)


def test_a_sound_mesh_is_left_alone() -> None:
    mesh = dome()
    checked, notes = repair_mesh(mesh, need_texture=True)
    assert notes == []
    assert np.array_equal(checked.triangles, mesh.triangles)
    assert np.array_equal(checked.vertices, mesh.vertices)
    assert np.array_equal(checked.uv[checked.uv_triangles], mesh.uv[mesh.uv_triangles])


def test_a_mesh_without_faces_is_refused() -> None:
    with pytest.raises(InputError, match="dome has no faces"):
        repair_mesh(Mesh(dome().vertices, np.zeros((0, 3), int), name="dome"))


def test_faces_out_of_range_are_refused() -> None:
    mesh = dome()
    with pytest.raises(InputError, match="dome has a face with vertex 62, and there are 62"):
        repair_mesh(replace(mesh, vertices=mesh.vertices[:-1]))
    with pytest.raises(InputError, match="dome has a face with texture coordinate 62"):
        repair_mesh(replace(mesh, uv=mesh.uv[:-1]))


def test_a_few_vertices_that_are_nan_are_removed_with_their_faces() -> None:
    mesh = replace_x(dome(), v0=np.nan, v3=np.inf)
    checked, notes = repair_mesh(mesh)
    assert notes == ["dome: 2 vertices that are NaN or infinite were removed with their faces."]
    assert np.isfinite(checked.vertices).all() and len(checked.vertices) == 61
    assert len(checked.uv_triangles) == len(checked.triangles)


def test_many_vertices_that_are_nan_are_refused() -> None:
    mesh = replace_x(dome(), **{f"v{i}": np.nan for i in range(20)})
    with pytest.raises(InputError, match="dome is damaged: 20 of its 63 vertices are NaN"):
        repair_mesh(mesh)


def test_faces_without_area_and_repeated_ones_are_removed() -> None:
    mesh = dome()
    extra = np.array([[0, 0, 1], [5, 5, 5], [12, 11, 4]])
    triangles = np.concatenate([mesh.triangles, extra])
    assert sorted(extra[2]) in np.sort(mesh.triangles, 1).tolist()
    checked, notes = repair_mesh(Mesh(mesh.vertices, triangles, name="dome"))
    assert notes == [
        "dome: 2 faces without an area were removed.",
        "dome: 1 repeated faces were removed.",
    ]
    assert np.array_equal(checked.triangles, mesh.triangles)
    flat = np.concatenate([mesh.triangles, np.zeros((20, 3), int)])
    with pytest.raises(InputError, match="20 of its 116 faces have no area"):
        repair_mesh(Mesh(mesh.vertices, flat, name="dome"))


def test_a_fin_at_an_edge_is_removed() -> None:
    mesh = dome()
    tip = mesh.vertices[[24]] + [1.0, 1.0, 5.0]
    fin = np.array([[24, 25, len(mesh.vertices)]])
    made = Mesh(
        np.concatenate([mesh.vertices, tip]), np.concatenate([mesh.triangles, fin]), name="dome"
    )
    checked, notes = repair_mesh(made)
    assert notes == [
        "dome: 1 edges had more than two faces (not manifold); the smallest 1 faces there were "
        "removed."
    ]
    assert np.array_equal(checked.vertices, mesh.vertices)


def test_small_components_are_removed_and_large_ones_stay() -> None:
    crumb, other = move(dome(), 500.0, 0.1), move(dome(), 900.0, 0.5)
    checked, notes = repair_mesh(join_meshes(dome(), crumb, other))
    assert notes == ["dome: 1 of 3 components were removed, 0.79% of the area."]
    assert len(checked.vertices) == 126


def test_a_mesh_in_pieces_is_refused() -> None:
    mesh = dome()
    soup = Mesh(mesh.vertices[mesh.triangles].reshape(-1, 3), np.arange(288).reshape(-1, 3))
    with pytest.raises(InputError, match=r"mesh is in 96 pieces, the largest with \d% of the area"):
        repair_mesh(soup)


@pytest.mark.parametrize("share", [0.3, 0.7, 1.0])
def test_flipped_faces_are_flipped_back(share: float) -> None:
    mesh = dome()
    flipped = np.random.default_rng(0).random(len(mesh.triangles)) < share
    triangles = np.where(flipped[:, None], mesh.triangles[:, ::-1], mesh.triangles)
    checked, notes = repair_mesh(replace(mesh, triangles=triangles, uv_triangles=triangles))
    assert len(notes) == (2 if share == 0.7 else 1)
    assert not is_inside_out(checked.vertices, checked.triangles)
    solid = trimesh.Trimesh(checked.vertices, checked.triangles, process=False)
    assert solid.is_winding_consistent
    assert np.array_equal(checked.triangles, checked.uv_triangles)


def test_a_strip_that_cannot_be_oriented_is_left_as_it_is() -> None:
    checked, _ = repair_mesh(Mesh(*moebius_strip()))
    assert len(checked.triangles) == 48


def test_a_texture_is_needed_only_on_request() -> None:
    mesh = dome()
    bare = Mesh(mesh.vertices, mesh.triangles, name="scan.ply")
    assert repair_mesh(bare).notes == []
    grey = np.repeat(mesh.texture[..., :1], 3, 2)
    portrait = make_colour()
    cases = {
        "no texture coordinates": bare,
        "NaN": replace(mesh, uv=mesh.uv * np.nan),
        "no texture: its material names no picture": replace(mesh, texture=None),
        "2 x 3 pixels, a placeholder": replace(mesh, texture=mesh.texture[:3, :2]),
        "a grey texture": replace(mesh, texture=grey),
        r"a brown \(sepia\) texture": replace(mesh, texture=TONES["brown sepia"](portrait)),
        r"a blue \(cyanotype\) texture": replace(mesh, texture=TONES["cyanotype"](portrait)),
    }
    for fault, case in cases.items():
        with pytest.raises(InputError, match=f"{case.name} has .*{fault}"):
            repair_mesh(case, need_texture=True)


def test_coordinates_in_other_tiles_are_wrapped() -> None:
    mesh = dome()
    checked, notes = repair_mesh(replace(mesh, uv=mesh.uv + [2, -1]), need_texture=True)
    assert notes == ["dome: 96 faces outside the texture were wrapped onto it."]
    assert np.allclose(checked.uv[checked.uv_triangles], mesh.uv[mesh.uv_triangles])


def test_faces_across_the_border_of_the_texture_are_refused() -> None:
    mesh = dome()
    with pytest.raises(InputError, match=r"dome has 16 faces across the border of its texture"):
        repair_mesh(replace(mesh, uv=mesh.uv + [0.1, 0]), need_texture=True)


def test_real_scans_need_little(shared_data: Path) -> None:
    _, notes = repair_mesh(read_mesh(shared_data / "scans/lps/head.obj"), need_texture=True)
    assert notes == []
    _, notes = repair_mesh(read_mesh(shared_data / "scans/james/james.obj"), need_texture=True)
    assert len(notes) == 1 and "9 of 10 components were removed, 0.16% of the area" in notes[0]
