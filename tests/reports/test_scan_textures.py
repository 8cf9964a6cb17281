"""The texture of a scan is the picture that its material names, or a sentence says which is not."""

from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from skinnet.cli import main
from skinnet.errors import InputError
from skinnet.mesh import Mesh, read_mesh
from skinnet.mesh._sampling import sample_bilinear

SIZE = 16
PLACES = (np.arange(7) + 0.5) / 7
SQUARE = (
    "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"
    "usemtl skin\nf 1/1 2/2 3/3\nf 1/1 3/3 4/4\n"
)
OBJ = "mtllib a.mtl\n" + SQUARE


def make_skin(seed: int = 0) -> np.ndarray:
    """A picture of which no two texels are equal, in the colours of skin."""
    rows, columns = np.mgrid[:SIZE, :SIZE]
    return np.stack([180 + 2 * rows + seed, 90 + 4 * columns, 80 + rows + columns], -1).astype(
        np.uint8
    )


SKIN = make_skin()
NORMALS = np.tile(np.uint8([128, 128, 255]), (SIZE, SIZE, 1))
NORMALS[..., 0] += np.arange(SIZE, dtype=np.uint8)


def write(folder: Path, **files: object) -> Path:
    """Write files: texts, bytes, and arrays as pictures. `__` in a name stands for a full stop."""
    for name, content in files.items():
        path = folder / name.replace("__", ".")
        path.parent.mkdir(parents=True, exist_ok=True)
        if isinstance(content, np.ndarray):
            Image.fromarray(content).save(path)
        else:
            path.write_bytes(content if isinstance(content, bytes) else str(content).encode())
    return folder / "a.obj"


def write_named(folder: Path, statement: str | bytes, **files: object) -> Path:
    """Write a scan whose material has the statement."""
    line = statement if isinstance(statement, bytes) else statement.encode()
    return write(folder, a__obj=OBJ, a__mtl=b"newmtl skin\n" + line + b"\n", **files)


def look(mesh: Mesh) -> np.ndarray:
    """Colours of the square at `PLACES`, [y, x, 3]."""
    assert mesh.texture is not None and mesh.uv is not None and mesh.uv_triangles is not None
    seen = np.full((len(PLACES), len(PLACES), 3), np.nan)
    for triangle, uv in zip(mesh.vertices[mesh.triangles], mesh.uv[mesh.uv_triangles], strict=True):
        matrix = (triangle[1:, :2] - triangle[0, :2]).T
        for row, y in enumerate(PLACES):
            for column, x in enumerate(PLACES):
                second, third = np.linalg.solve(matrix, [x, y] - triangle[0, :2])
                weights = np.array([1 - second - third, second, third])
                if (weights >= -1e-9).all():
                    seen[row, column] = sample_bilinear(mesh.texture, (weights @ uv)[None])[0]
    return seen


def show(picture: np.ndarray, scale: object = (1, 1), offset: object = (0, 0)) -> np.ndarray:
    """What is right: a repeated picture at scaled and shifted coordinates."""
    x, y = np.meshgrid(PLACES, PLACES)
    uv = np.stack([x, y], -1) * np.array(scale) + np.array(offset)
    repeated = np.tile(picture, (3, 3, 1))
    inside = (uv - np.floor(uv) + 1) / 3
    return np.array([sample_bilinear(repeated, row) for row in inside])


def assert_skin(mesh: Mesh, picture: np.ndarray = SKIN) -> None:
    assert np.array_equal(mesh.texture, picture)
    assert np.allclose(look(mesh), show(picture), atol=1e-3)


NAMES = {
    "plain": ("map_Kd t.png", "t.png"),
    "lower case keyword": ("map_kd t.png", "t.png"),
    "indented, with tabs": ("\t map_Kd\tt.png \t", "t.png"),
    "spaces": ("map_Kd my skin 1.png", "my skin 1.png"),
    "quotes": ('map_Kd "my skin.png"', "my skin.png"),
    "single quotes": ("map_Kd 'my skin.png'", "my skin.png"),
    "another case": ("map_Kd Skin.PNG", "sKIN.png"),
    "folder": ("map_Kd maps/t.png", "maps/t.png"),
    "folder of another case": ("map_Kd Maps/T.png", "mAPS/t.PNG"),
    "back-slash": ("map_Kd maps\\t.png", "maps/t.png"),
    "back-slash in the name on the disk": ("map_Kd maps\\t.png", "maps\\t.png"),
    "double back-slash": ("map_Kd maps\\\\t.png", "maps/t.png"),
    "dot": ("map_Kd ./t.png", "t.png"),
    "dot and back-slash": ("map_Kd .\\t.png", "t.png"),
    "percent-encoded": ("map_Kd my%20skin.png", "my skin.png"),
    "percent sign": ("map_Kd 100%25.png", "100%25.png"),
    "number sign": ("map_Kd skin #2.png", "skin #2.png"),
    "comment": ("map_Kd t.png # the skin", "t.png"),
    "no ending": ("map_Kd skin", "skin"),
    "wrong ending": ("map_Kd t.jpg", "t.jpg"),
    "hyphen": ("map_Kd -skin-.png", "-skin-.png"),
    "number": ("map_Kd 5.png", "5.png"),
    "UTF-8": ("map_Kd Köpfchen 顔.png", "Köpfchen 顔.png"),
    "another normal form": ("map_Kd K\u00f6pfchen.png", "Ko\u0308pfchen.png"),
    "Latin-1": ("map_Kd Köpfchen.png".encode("latin-1"), "Köpfchen.png"),
    "GB 18030": ("map_Kd 脸.png".encode("gb18030"), "脸.png"),
    "Shift JIS": ("map_Kd 顔写真.png".encode("shift_jis"), "顔写真.png"),
    "CR LF": ("Ks 0 0 0\r\nmap_Kd t.png\r", "t.png"),
    "CR": ("Ks 0 0 0\rmap_Kd t.png\r", "t.png"),
    "twice the same": ("map_Kd t.png\nmap_Kd t.png", "t.png"),
    "options without effect": ("map_Kd -blendu off -blendv on -bm 0.5 -texres 512 t.png", "t.png"),
    "options with their default": ("map_Kd -mm 0 1 -t 0 0 0 -o 0 0 0 -s 1 1 1 t.png", "t.png"),
    "clamped": ("map_Kd -clamp on t.png", "t.png"),
    "option before spaces": ("map_Kd -s 1 1 1 my skin.png", "my skin.png"),
    "Kd black": ("Kd 0 0 0\nmap_Kd t.png", "t.png"),
    "Kd grey": ("Kd 0.8 0.8 0.8\nmap_Kd t.png", "t.png"),
    "Kd of one number": ("Kd 0.6\nmap_Kd t.png", "t.png"),
    "Kd after the picture": ("map_Kd t.png\nKd 0.588 0.588 0.588", "t.png"),
    "Tr": ("Tr 1.0\nmap_Kd t.png", "t.png"),
    "d": ("d 1.0\nmap_Kd t.png", "t.png"),
}


@pytest.mark.parametrize("kind", NAMES)
def test_the_picture_that_is_named_is_found(tmp_path: Path, kind: str) -> None:
    statement, name = NAMES[kind]
    path = write_named(tmp_path, statement, z__png=make_skin(9))
    write(tmp_path, p__png=SKIN)
    (tmp_path / name).parent.mkdir(exist_ok=True)
    (tmp_path / "p.png").rename(tmp_path / name)
    mesh = read_mesh(path)
    assert_skin(mesh)
    assert mesh.notes == ()


@pytest.mark.parametrize(
    "name",
    [
        "C:\\Users\\me\\scans\\t.png",
        "C:/Users/me/t.png",
        '"D:\\my scans\\T.PNG"',
        "\\\\server\\share\\t.png",
        "/home/me/scans/t.png",
        "file:///C:/scans/t.png",
        "textures/t.png",
        "../textures/t.png",
        "..\\t.png",
        "https://example.org/t.png",
    ],
)
def test_in_place_of_a_path_of_another_machine_its_name_is_taken(tmp_path: Path, name: str) -> None:
    mesh = read_mesh(write_named(tmp_path, f"map_Kd {name}", t__png=SKIN, z__png=make_skin(9)))
    assert_skin(mesh)
    (note,) = mesh.notes
    assert "is taken" in note and name.strip('"') in note


def test_the_end_of_a_path_is_taken_with_its_folders(tmp_path: Path) -> None:
    path = write_named(tmp_path, "map_Kd C:\\scans\\maps\\t.png", t__png=make_skin(9))
    write(tmp_path / "maps", t__png=SKIN)
    assert_skin(read_mesh(path))


MISSING = {
    "missing": "map_Kd gone.png",
    "missing with options": "map_Kd -s 1 1 1 gone.png",
    "missing beside other maps": "map_Kd gone.png\nmap_Bump n.png\nmap_Ka z.png",
    "missing of another machine": "map_Kd C:\\scans\\gone.png",
    "missing with spaces": "map_Kd my gone.png",
    "a folder": "map_Kd .",
    "options behind the name": "map_Kd gone.png -s 2 2 2",
    "an unknown option": "map_Kd -gamma 2 gone.png",
    "tiles": "map_Kd gone.<UDIM>.png",
}


@pytest.mark.parametrize("kind", MISSING)
def test_a_picture_that_is_missing_is_named(tmp_path: Path, kind: str) -> None:
    statement = MISSING[kind]
    path = write_named(tmp_path, statement, n__png=NORMALS, z__png=SKIN, a__png=make_skin(9))
    name = "." if kind == "a folder" else "gone"
    with pytest.raises(
        InputError, match=rf"map_Kd of material 'skin' \(line 2 of .*a\.mtl\).*{name}"
    ):
        read_mesh(path)
    assert_skin(read_mesh(path, texture=tmp_path / "z.png"))


def test_a_picture_of_another_format_is_not_taken_but_named(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"'t\.jpg'.*\(t\.png is there\)"):
        read_mesh(write_named(tmp_path, "map_Kd t.jpg", t__png=SKIN))


PLACEMENTS = {
    "scale": ("-s 2 3 1", (2, 3), (0, 0)),
    "scale of u alone": ("-s 2", (2, 1), (0, 0)),
    "offset": ("-o 0.25 0.5 0", (1, 1), (0.25, 0.5)),
    "scale and offset": ("-s 0.5 0.5 1 -o 0.25 -0.25", (0.5, 0.5), (0.25, -0.25)),
    "offset and scale": ("-o 0.3 0.1 -clamp off -s 0.5 2", (0.5, 2), (0.3, 0.1)),
    "upside down": ("-s 1 -1 1", (1, -1), (0, 0)),
    "upside down, shifted": ("-s 1 -1 1 -o 0 1 0", (1, -1), (0, 1)),
    "whole tiles": ("-o 3 -2 0", (1, 1), (3, -2)),
}


@pytest.mark.parametrize("given", [False, True])
@pytest.mark.parametrize("kind", PLACEMENTS)
def test_scale_and_offset_are_applied(tmp_path: Path, kind: str, given: bool) -> None:
    options, scale, offset = PLACEMENTS[kind]
    path = write_named(tmp_path, f"map_Kd {options} my skin.png", t__png=SKIN)
    (tmp_path / "my skin.png").write_bytes((tmp_path / "t.png").read_bytes())
    mesh = read_mesh(path, tmp_path / "t.png" if given else None)
    assert np.allclose(look(mesh), show(SKIN, scale, offset), atol=0.6)


def test_a_clamped_picture_ends_at_its_border(tmp_path: Path) -> None:
    path = write_named(tmp_path, "map_Kd -clamp on -s 2 1 1 t.png", t__png=SKIN)
    seen = look(read_mesh(path))
    assert np.allclose(seen[:, -1], look(read_mesh(path))[:, -2], atol=1)
    assert np.allclose(seen[:, -1, 1], SKIN[0, -1, 1], atol=1)


@pytest.mark.parametrize(
    "option", ["-mm 0.1 1", "-mm 0 0.5", "-t 1 1 1", "-imfchan r", "-cc on", "-type sphere"]
)
def test_options_that_are_not_applied_are_refused_by_name(tmp_path: Path, option: str) -> None:
    path = write_named(tmp_path, f"map_Kd {option} t.png", t__png=SKIN)
    with pytest.raises(InputError, match=f"option {option.split()[0]} .*--texture"):
        read_mesh(path)
    assert_skin(read_mesh(path, texture=tmp_path / "t.png"))


LIBRARIES = {
    "two lines": ("mtllib b.mtl\nmtllib a.mtl\n", True),
    "two in one line": ("mtllib b.mtl a.mtl\n", True),
    "the second is missing": ("mtllib a.mtl gone.mtl\n", True),
    "another case": ("mtllib A.MTL\n", True),
    "spaces": ("mtllib my head.mtl\n", True),
    "spaces, and a second": ("mtllib b.mtl my head.mtl\n", True),
    "quotes": ('mtllib "my head.mtl"\n', True),
    "dot and back-slash": ("mtllib .\\a.mtl\n", True),
    "after the faces": ("", True),
}


@pytest.mark.parametrize("kind", LIBRARIES)
def test_the_materials_files_are_found(tmp_path: Path, kind: str) -> None:
    head, _ = LIBRARIES[kind]
    name = "my head.mtl" if "my head" in head else "a.mtl"
    tail = "" if head else "mtllib a.mtl\n"
    path = write(tmp_path, a__obj=head + SQUARE + tail, b__mtl="newmtl eye\nmap_Kd e.png\n")
    write(tmp_path, t__png=SKIN, e__png=make_skin(9))
    (tmp_path / name).write_text("newmtl skin\nmap_Kd t.png\n")
    mesh = read_mesh(path)
    assert_skin(mesh)
    assert mesh.notes == ()


def test_the_first_definition_of_a_material_is_taken(tmp_path: Path) -> None:
    path = write(tmp_path, a__obj="mtllib a.mtl b.mtl\n" + SQUARE, t__png=SKIN, u__png=make_skin(9))
    write(tmp_path, a__mtl="newmtl skin\nmap_Kd t.png\n", b__mtl="newmtl skin\nmap_Kd u.png\n")
    assert_skin(read_mesh(path))


@pytest.mark.parametrize("name", ["Skin", "SKIN", "skin  "])
def test_names_of_materials_may_differ_in_case(tmp_path: Path, name: str) -> None:
    path = write(tmp_path, a__obj=OBJ, a__mtl=f"newmtl {name}\nmap_Kd t.png\n", t__png=SKIN)
    assert_skin(read_mesh(path))


def test_a_materials_file_of_the_meshs_name_stands_in_for_one_that_is_missing(
    tmp_path: Path,
) -> None:
    path = write(tmp_path, a__obj="mtllib head_01.mtl\n" + SQUARE, t__png=SKIN)
    write(tmp_path, a__mtl="newmtl skin\nmap_Kd t.png\n")
    mesh = read_mesh(path)
    assert_skin(mesh)
    assert any("are taken from a.mtl" in note for note in mesh.notes)


def test_a_missing_materials_file_is_said(tmp_path: Path) -> None:
    path = write(tmp_path, a__obj="mtllib gone.mtl\n" + SQUARE, t__png=SKIN, n__png=NORMALS)
    mesh = read_mesh(path)
    assert mesh.texture is None
    assert any("gone.mtl (line 1), and there is no such file" in note for note in mesh.notes)
    assert any("'skin' (line 10), which no MTL file defines" in note for note in mesh.notes)


def test_no_plain_colour_stands_in_for_a_material_that_is_not_defined(tmp_path: Path) -> None:
    path = write_named(tmp_path, "map_Kd t.png", t__png=SKIN)
    path.write_text(OBJ.replace("f 1/1 3/3", "usemtl face\nf 1/1 3/3"))
    with pytest.raises(InputError, match=r"material 'face' \(line 12\), which no MTL file defines"):
        read_mesh(path)


def test_the_only_material_is_that_of_a_mesh_without_usemtl(tmp_path: Path) -> None:
    path = write_named(tmp_path, "map_Kd t.png", t__png=SKIN)
    path.write_text(OBJ.replace("usemtl skin\n", ""))
    mesh = read_mesh(path)
    assert_skin(mesh)
    assert any("no usemtl line" in note for note in mesh.notes)


@pytest.mark.parametrize(
    "statement",
    ["map_Bump t.png", "bump t.png", "map_bump -bm 1 t.png", "norm t.png", "map_Ks t.png"]
    + ["map_Ns t.png", "map_Pr t.png", "map_d t.png", "disp t.png", "map_Ke t.png", "refl t.png"],
)
def test_another_map_never_becomes_skin(tmp_path: Path, statement: str) -> None:
    for name in ("a.png", "albedo.png"):
        path = write_named(tmp_path, statement, t__png=NORMALS)
        Image.fromarray(SKIN).save(tmp_path / name)
        mesh = read_mesh(path)
        assert mesh.texture is None
        assert any("t.png" in note and "no picture of their colour" in note for note in mesh.notes)
        (tmp_path / name).unlink()


def test_other_maps_beside_the_skin_are_passed_over(tmp_path: Path) -> None:
    lines = (
        "map_Bump -bm 1 n.png\nnorm n.png\nmap_Ks s.png\nmap_Kd t.png\nmap_Ka z.png\nmap_d d.png"
    )
    path = write_named(tmp_path, lines, t__png=SKIN, n__png=NORMALS, z__png=make_skin(9))
    assert_skin(read_mesh(path))


def test_a_picture_of_the_ambient_colour_is_taken_if_it_is_the_only_one(tmp_path: Path) -> None:
    mesh = read_mesh(write_named(tmp_path, "map_Ka t.png\nmap_Bump n.png", t__png=SKIN))
    assert_skin(mesh)
    assert any("map_Ka" in note and "ambient" in note for note in mesh.notes)


def test_a_normal_map_is_known_by_its_colours(tmp_path: Path) -> None:
    path = write_named(tmp_path, "map_Kd t.png", t__png=NORMALS)
    with pytest.raises(InputError, match=r"t\.png is a normal map"):
        read_mesh(path)
    with pytest.raises(InputError, match=r"t\.png is a normal map"):
        read_mesh(path, texture=tmp_path / "t.png")


@pytest.mark.parametrize("colour", ["0.9 0.6 0.5", "1 0 0", "0.8 0.7 0.8"])
def test_a_coloured_kd_beside_a_picture_is_refused(tmp_path: Path, colour: str) -> None:
    path = write_named(tmp_path, f"Kd {colour}\nmap_Kd t.png", t__png=SKIN)
    with pytest.raises(InputError, match=f"Kd {colour}; .*--texture"):
        read_mesh(path)
    assert_skin(read_mesh(path, texture=tmp_path / "t.png"))


def test_two_pictures_of_one_material_are_refused(tmp_path: Path) -> None:
    for statement in ("map_Kd t.png\nmap_Kd z.png", "map_Kd t.png\nnewmtl skin\nmap_Kd z.png"):
        path = write_named(tmp_path, statement, t__png=SKIN, z__png=make_skin(9))
        with pytest.raises(InputError, match=r"second picture|twice"):
            read_mesh(path)


def test_faces_without_a_picture_have_their_materials_colour_and_it_is_said(tmp_path: Path) -> None:
    path = write_named(tmp_path, "map_Kd t.png\nnewmtl eye\nKd 0 1 0", t__png=SKIN)
    path.write_text(OBJ.replace("f 1/1 3/3", "usemtl eye\nf 1/1 3/3"))
    mesh = read_mesh(path)
    seen = look(mesh)
    assert np.allclose(seen[6, 0], [0, 255, 0]) and np.allclose(seen[0, 6], show(SKIN)[0, 6])
    assert any("1 triangles of material 'eye' have no picture" in note for note in mesh.notes)


def test_transparency_that_no_material_uses_is_not_blended(tmp_path: Path) -> None:
    half = np.dstack([SKIN, np.full((SIZE, SIZE), 128, np.uint8)])
    mesh = read_mesh(write_named(tmp_path, "map_Kd t.png", t__png=half))
    assert_skin(mesh)
    assert any("its alpha is not opacity" in note for note in mesh.notes)
    used = read_mesh(write_named(tmp_path, "map_Kd t.png\nmap_d t.png", t__png=half))
    assert np.allclose(used.texture, SKIN * (128 / 255) + 255 * (127 / 255), atol=1)


@pytest.mark.parametrize("suffix", ["tga", "bmp", "tif", "webp", "ppm", "dds"])
def test_pictures_of_every_format_are_read(tmp_path: Path, suffix: str) -> None:
    path = write_named(tmp_path, f"map_Kd t.{suffix}")
    options = {"lossless": True} if suffix == "webp" else {}
    Image.fromarray(SKIN).save(tmp_path / f"t.{suffix}", **options)
    assert_skin(read_mesh(path))


def test_an_orientation_is_not_applied(tmp_path: Path) -> None:
    path = write_named(tmp_path, "map_Kd t.png")
    exif = Image.Exif()
    exif[0x0112] = 6
    Image.fromarray(SKIN).save(tmp_path / "t.png", exif=exif)
    assert_skin(read_mesh(path))


BESIDE = {
    "the mesh's name": ("a.png", True),
    "the mesh's name in another case": ("A.PNG", True),
    "the mesh's name and a word": ("a_albedo.png", True),
    "a word for colour": ("albedo.png", True),
    "any name": ("IMG_1234.png", False),
    "a preview": ("a_preview.png", False),
    "normals": ("normals.png", False),
    "normals with the mesh's name": ("a_normal.png", False),
    "roughness": ("a_roughness.png", False),
    "occlusion": ("a_ao.png", False),
    "specular colour": ("specular_color.png", False),
}


@pytest.mark.parametrize("kind", BESIDE)
def test_a_mesh_that_names_no_picture_has_one_by_name_alone(tmp_path: Path, kind: str) -> None:
    name, taken = BESIDE[kind]
    path = write(tmp_path, a__obj=SQUARE.replace("usemtl skin\n", ""))
    Image.fromarray(SKIN).save(tmp_path / name)
    mesh = read_mesh(path)
    assert (mesh.texture is not None) == taken
    assert any(name in note and "names no picture" in note for note in mesh.notes)


PLY = """ply
format ascii 1.0
{comments}element vertex 4
property float x
property float y
property float z
property float s
property float t
element face 2
property list uchar int vertex_indices
end_header
0 0 0 0 0
1 0 0 1 0
1 1 0 1 1
0 1 0 0 1
3 0 1 2
3 0 2 3
"""


@pytest.mark.parametrize(
    "name", ["t.png", "T.PNG", "C:\\scans\\t.png", '"t.png"', "./t.png", "t.png\r"]
)
def test_the_texture_of_a_ply_is_found(tmp_path: Path, name: str) -> None:
    path = tmp_path / "a.ply"
    write(tmp_path, t__png=SKIN, z__png=make_skin(9))
    path.write_text(PLY.format(comments=f"comment TextureFile {name}\n"), newline="")
    assert_skin(read_mesh(path))


@pytest.mark.parametrize("name", ["gone.png", "C:\\scans\\gone.png"])
def test_a_texture_of_a_ply_that_is_missing_is_named(tmp_path: Path, name: str) -> None:
    path = tmp_path / "a.ply"
    write(tmp_path, a__png=SKIN)
    path.write_text(PLY.format(comments=f"comment TextureFile {name}\n"))
    with pytest.raises(InputError, match=r"a\.ply names the picture '.*gone\.png'.*--texture"):
        read_mesh(path)


def test_a_ply_with_two_textures_is_read_by_the_numbers_of_its_faces(tmp_path: Path) -> None:
    path = tmp_path / "a.ply"
    write(tmp_path, t__png=SKIN, u__png=make_skin(40))
    text = PLY.format(comments="comment TextureFile t.png\ncomment TextureFile u.png\n")
    path.write_text(text)
    with pytest.raises(InputError, match=r"t\.png, u\.png, and does not say"):
        read_mesh(path)
    text = text.replace("vertex_indices\n", "vertex_indices\nproperty int texnumber\n")
    path.write_text(text.replace("3 0 1 2\n3 0 2 3\n", "3 0 1 2 1\n3 0 2 3 0\n"))
    seen = look(read_mesh(path))
    assert np.allclose(seen[0, 6], show(make_skin(40))[0, 6], atol=1e-3)
    assert np.allclose(seen[6, 0], show(SKIN)[6, 0], atol=1e-3)


@pytest.mark.parametrize("command", ["maps", "fit-shape"])
@pytest.mark.parametrize("suffix", ["obj", "ply"])
def test_the_program_names_the_picture_and_goes_on(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], command: str, suffix: str
) -> None:
    path = write_named(tmp_path, "map_Kd gone.png", n__png=NORMALS)
    (tmp_path / "b.ply").write_text(PLY.format(comments="comment TextureFile gone.png\n"))
    scan = path if suffix == "obj" else tmp_path / "b.ply"
    other = write(tmp_path / "other", a__obj="f 1 2 3\n").rename(tmp_path / "other" / "c.obj")
    assert main([command, str(scan), str(other), "-o", str(tmp_path / "out")]) == 2
    said = capsys.readouterr().err
    assert "gone.png" in said and "--texture" in said and "c.obj" in said
    assert not list((tmp_path / "out").glob("*"))
