"""Meshes come back as they were written, seams joined, with the texture that belongs to them."""

from pathlib import Path

import numpy as np
import pytest
import trimesh
from PIL import Image
from small_meshes import dome

from skinnet.errors import InputError
from skinnet.mesh.mesh import Mesh
from skinnet.mesh.mesh_file import read_mesh, write_mesh

SQUARE = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"


def picture(path: Path, colour: tuple[int, int, int] = (200, 120, 90), size: int = 16) -> Path:
    Image.new("RGB", (size, size), colour).save(path)
    return path


def same_corners(one: Mesh, other: Mesh) -> bool:
    assert one.uv is not None and other.uv is not None
    return np.allclose(
        one.vertices[one.triangles], other.vertices[other.triangles], rtol=1e-8
    ) and np.allclose(one.uv[one.uv_triangles], other.uv[other.uv_triangles], atol=1e-6)


@pytest.mark.parametrize("suffix", [".obj", ".ply"])
def test_a_mesh_comes_back_with_its_texture(tmp_path: Path, suffix: str) -> None:
    mesh = dome()
    write_mesh(tmp_path / f"a face{suffix}", mesh)
    read = read_mesh(tmp_path / f"a face{suffix}")
    assert np.array_equal(read.triangles, mesh.triangles) and same_corners(read, mesh)
    assert np.array_equal(read.texture, mesh.texture)
    assert read.name == str(tmp_path / f"a face{suffix}")


@pytest.mark.parametrize("suffix", [".obj", ".ply"])
def test_a_mesh_without_a_texture_is_one_file(tmp_path: Path, suffix: str) -> None:
    bare = Mesh(dome().vertices, dome().triangles)
    write_mesh(tmp_path / f"bare{suffix}", bare)
    read = read_mesh(tmp_path / f"bare{suffix}")
    assert [path.name for path in tmp_path.iterdir()] == [f"bare{suffix}"]
    assert read.uv is None and read.texture is None
    assert np.allclose(read.vertices, bare.vertices, rtol=1e-8)


def test_writing_that_fails_leaves_nothing(tmp_path: Path) -> None:
    (tmp_path / "face.png").mkdir()
    with pytest.raises(InputError, match=r"face\.png is a folder"):
        write_mesh(tmp_path / "face.obj", dome())
    assert [path.name for path in tmp_path.iterdir()] == ["face.png"]
    with pytest.raises(InputError, match=r"written as \.obj or \.ply"):
        write_mesh(tmp_path / "face.fbx", dome())


def test_a_vertex_on_a_seam_has_one_position_and_two_coordinates(tmp_path: Path) -> None:
    path = tmp_path / "seam.obj"
    path.write_text(
        SQUARE + "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nvt .5 .5\nf 4/4 1/1 3/3\nf 1/5 2/2 3/3\n"
    )
    mesh = read_mesh(path)
    assert np.array_equal(mesh.vertices[:, :2], [[0, 0], [1, 0], [1, 1], [0, 1]])
    assert mesh.triangles.tolist() == [[3, 0, 2], [0, 1, 2]]
    assert len(mesh.uv) == 5
    assert mesh.uv[mesh.uv_triangles][1].tolist() == [[0.5, 0.5], [1, 0], [1, 1]]


def test_vertices_keep_the_order_of_the_file_over_materials(tmp_path: Path) -> None:
    path = tmp_path / "two.obj"
    path.write_text(
        "mtllib two.mtl\n" + SQUARE + "v 9 9 9\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"
        "usemtl a\nf 1/1 3/3 4/4\nusemtl b\nf 1/1 2/2 3/3\n"
    )
    picture(tmp_path / "a.png", (250, 0, 0), 8)
    picture(tmp_path / "b.png", (0, 0, 250), 4)
    (tmp_path / "two.mtl").write_text("newmtl a\nmap_Kd a.png\nnewmtl b\nmap_Kd b.png\n")
    mesh = read_mesh(path)
    assert np.array_equal(mesh.vertices[:, :2], [[0, 0], [1, 0], [1, 1], [0, 1]])
    assert mesh.texture.shape == (8, 12, 3)
    for triangle, corners in zip(mesh.triangles, mesh.uv[mesh.uv_triangles], strict=True):
        u, v = corners.mean(0)
        texel = mesh.texture[int((1 - v) * 8), int(u * 12)]
        assert texel.argmax() == (0 if 3 in triangle else 2)


def test_a_part_without_a_picture_has_its_materials_colour(tmp_path: Path) -> None:
    path = tmp_path / "plain.obj"
    path.write_text(
        "mtllib plain.mtl\n" + SQUARE + "vt 0 0\nvt 1 0\nvt 1 1\n"
        "usemtl skin\nf 1/1 2/2 3/3\nusemtl eye\nf 1 3 4\n"
    )
    picture(tmp_path / "skin.png")
    (tmp_path / "plain.mtl").write_text("newmtl skin\nmap_Kd skin.png\nnewmtl eye\nKd 0 1 0\n")
    mesh = read_mesh(path)
    eye = mesh.uv_triangles[(mesh.triangles == 3).any(1)]
    u, v = mesh.uv[eye].reshape(-1, 2).mean(0)
    rows, columns = mesh.texture.shape[:2]
    assert mesh.texture[int((1 - v) * rows), int(u * columns)].tolist() == [0, 255, 0]


def test_gltf_is_read_with_its_texture_the_right_way_up(tmp_path: Path) -> None:
    mesh = dome()
    image = Image.fromarray(mesh.texture)
    material = trimesh.visual.material.PBRMaterial(baseColorTexture=image)
    visual = trimesh.visual.TextureVisuals(mesh.uv, material)
    made = trimesh.Trimesh(mesh.vertices, mesh.triangles, visual=visual, process=False)
    made.export(tmp_path / "face.glb")
    read = read_mesh(tmp_path / "face.glb")
    assert np.allclose(read.vertices[read.triangles], mesh.vertices[mesh.triangles], rtol=1e-6)
    assert np.allclose(read.uv[read.uv_triangles], mesh.uv[mesh.uv_triangles], atol=1e-6)
    assert np.array_equal(read.texture, mesh.texture)


def test_parts_of_a_scene_are_placed_and_joined(tmp_path: Path) -> None:
    scene = trimesh.Scene()
    box = trimesh.creation.box()
    scene.add_geometry(box)
    scene.add_geometry(box, transform=trimesh.transformations.translation_matrix([5, 0, 0]))
    scene.export(tmp_path / "two.glb")
    mesh = read_mesh(tmp_path / "two.glb")
    assert len(mesh.vertices) == 16 and len(mesh.triangles) == 24
    assert np.ptp(mesh.vertices[:, 0]) == pytest.approx(6)


def test_stl_is_welded(tmp_path: Path) -> None:
    mesh = dome()
    trimesh.Trimesh(mesh.vertices, mesh.triangles).export(tmp_path / "face.stl")
    assert len(read_mesh(tmp_path / "face.stl").vertices) == len(mesh.vertices)


def test_the_texture_is_found_beside_the_mesh(tmp_path: Path) -> None:
    path = tmp_path / "head.obj"
    path.write_text(SQUARE + "vt 0 0\nvt 1 0\nvt 1 1\nf 1/1 2/2 3/3\n")
    assert read_mesh(path).texture is None
    picture(tmp_path / "albedo.jpg")
    assert read_mesh(path).texture.shape == (16, 16, 3)
    picture(tmp_path / "normals.png")
    assert read_mesh(path).texture is None
    picture(tmp_path / "head.png", size=20)
    assert read_mesh(path).texture.shape == (20, 20, 3)
    given = read_mesh(path, texture=tmp_path / "normals.png")
    assert given.texture.shape == (16, 16, 3)


def test_a_texture_lies_as_in_its_file_whatever_its_exif_says(tmp_path: Path) -> None:
    path = tmp_path / "head.obj"
    path.write_text(
        "mtllib head.mtl\n" + SQUARE + "vt 0 0\nvt 1 0\nvt 1 1\nusemtl a\nf 1/1 2/2 3/3\n"
    )
    (tmp_path / "head.mtl").write_text("newmtl a\nmap_Kd head.jpg\n")
    image, exif = Image.new("RGB", (20, 10), (200, 0, 0)), Image.Exif()
    exif[0x0112] = 6
    image.save(tmp_path / "head.jpg", exif=exif)
    assert read_mesh(path).texture.shape == (10, 20, 3)
    assert read_mesh(path, texture=tmp_path / "head.jpg").texture.shape == (10, 20, 3)


@pytest.mark.parametrize(
    ("name", "text", "fault"),
    [
        ("points.obj", SQUARE, "has no faces, only 4 points"),
        ("empty.obj", "", "has no faces"),
        ("far.obj", SQUARE + "f 1 2 9\n", "cannot be read as a mesh"),
        ("word.obj", "v 0 0 x\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "cannot be read as a mesh"),
        ("cut.ply", "ply\nformat ascii 1.0\nelement vertex 3\n", "cannot be read as a mesh"),
        ("cut.glb", "glTF", "cannot be read as a mesh"),
        ("scan.fbx", "", "is not a mesh file that can be read"),
    ],
)
def test_files_that_are_no_meshes_are_refused(
    tmp_path: Path, name: str, text: str, fault: str
) -> None:
    (tmp_path / name).write_text(text)
    with pytest.raises(InputError, match=f"{name} {fault}"):
        read_mesh(tmp_path / name)


def test_faces_out_of_range_are_refused(tmp_path: Path) -> None:
    mesh = dome()
    write_mesh(tmp_path / "face.ply", Mesh(mesh.vertices[:-1], mesh.triangles))
    with pytest.raises(InputError, match=r"face\.ply has a face with vertex 62, and 62 vertices"):
        read_mesh(tmp_path / "face.ply")


def test_missing_files_and_broken_textures_are_named(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"There is no mesh .*none\.obj"):
        read_mesh(tmp_path / "none.obj")
    write_mesh(tmp_path / "face.obj", dome())
    with pytest.raises(InputError, match=r"There is no texture .*none\.png"):
        read_mesh(tmp_path / "face.obj", texture=tmp_path / "none.png")
    (tmp_path / "text.png").write_text("not a picture")
    with pytest.raises(InputError, match=r"text\.png is not a picture"):
        read_mesh(tmp_path / "face.obj", texture=tmp_path / "text.png")
    png = tmp_path / "face.png"
    png.write_bytes(png.read_bytes()[:200])
    with pytest.raises(InputError, match=r"face\.png is damaged"):
        read_mesh(tmp_path / "face.obj")


@pytest.mark.parametrize(
    ("file", "vertices", "triangles", "texture"),
    [
        ("lps/head.obj", 8844, 17684, (1024, 1024, 3)),
        ("james/james.obj", 6393, 12228, (1600, 2400, 3)),
    ],
)
def test_real_scans_are_read_in_the_order_of_their_files(
    shared_data: Path, file: str, vertices: int, triangles: int, texture: tuple[int, int, int]
) -> None:
    path = shared_data / "scans" / file
    mesh = read_mesh(path)
    listed = [line.split()[1:4] for line in path.read_text().splitlines() if line[:2] == "v "]
    assert np.array_equal(mesh.vertices, np.array(listed, np.float64))
    assert (len(mesh.vertices), len(mesh.triangles)) == (vertices, triangles)
    assert mesh.texture.shape == texture
    assert mesh.uv.min() >= 0 and mesh.uv.max() <= 1


@pytest.mark.parametrize("named", ["../skin.png", "{}/skin.png", "file://{}/skin.png"])
def test_a_picture_outside_of_the_folder_is_refused_in_words(tmp_path: Path, named: str) -> None:
    """A mesh may come from anybody, and may name any file of the machine."""
    picture(tmp_path / "skin.png")
    (tmp_path / "scan").mkdir()
    path = tmp_path / "scan" / "a.obj"
    path.write_text(f"mtllib a.mtl\n{SQUARE}vt 0 0\nvt 1 0\nvt 1 1\nusemtl s\nf 1/1 2/2 3/3\n")
    path.with_suffix(".mtl").write_text(f"newmtl s\nmap_Kd {named.format(tmp_path)}\n")
    with pytest.raises(InputError, match=r"outside of the mesh's folder are not opened.*--texture"):
        read_mesh(path)
    assert read_mesh(path, tmp_path / "skin.png").texture is not None


def test_materials_outside_of_the_folder_are_not_opened(tmp_path: Path) -> None:
    (tmp_path / "a.mtl").write_text("newmtl s\nKd 1 0 0\n")
    (tmp_path / "scan").mkdir()
    path = tmp_path / "scan" / "b.obj"
    path.write_text(f"mtllib ../a.mtl\n{SQUARE}usemtl s\nf 1 2 3\n")
    notes = [each for each in read_mesh(path).notes if "a.mtl" in each]
    assert len(notes) == 1 and "outside of the mesh's folder" in notes[0]


def test_a_byte_that_is_not_utf_8_in_a_comment(tmp_path: Path) -> None:
    path = tmp_path / "a.obj"
    path.write_bytes(f"# Gr\u00f6\u00dfe\n{SQUARE}f 1 2 3\n".encode("latin-1"))
    assert read_mesh(path).triangles.tolist() == [[0, 1, 2]]
