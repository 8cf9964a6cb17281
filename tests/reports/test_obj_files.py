"""OBJ files in every way that tools write them give the mesh of the plain way, or a sentence."""

import random
from pathlib import Path

import numpy as np
import pytest

from skinnet.errors import InputError
from skinnet.mesh import Mesh, read_mesh

VERTICES = ("0 0 0", "2 0 0", "2 2 1", "0 2 0", "1 3 0.5")
COORDINATES = ("0 0", "1 0", "1 0.75", "0 0.75", "0.5 1")
FACES = ((1, 2, 3), (1, 3, 4), (4, 3, 5))


def lines(keyword: str, values: tuple[str, ...]) -> str:
    return "".join(f"{keyword} {value}\n" for value in values)


def faces(form: str) -> str:
    """Faces whose corners have the form; {0} is the index from 1, {n} the negative one."""
    rows = [" ".join(form.format(i, n=i - 6) for i in face) for face in FACES]
    return "".join(f"f {row}\n" for row in rows)


V, VT = lines("v", VERTICES), lines("vt", COORDINATES)
VN = "vn 0 0 1\n" * 5
PLAIN = V + VT + faces("{0}/{0}")
BARE = V + faces("{0}")


def read(folder: Path, text: str | bytes, name: str = "a.obj") -> Mesh:
    (folder / name).write_bytes(text if isinstance(text, bytes) else text.encode())
    return read_mesh(folder / name)


def assert_plain(mesh: Mesh, mapped: bool) -> None:
    vertices = np.array([row.split() for row in VERTICES], float)
    assert np.array_equal(mesh.vertices, vertices)
    assert mesh.triangles.tolist() == (np.array(FACES) - 1).tolist()
    if not mapped:
        assert mesh.uv is None
        return
    assert mesh.uv is not None and mesh.uv_triangles is not None
    coordinates = np.array([row.split() for row in COORDINATES], float)
    assert np.array_equal(mesh.uv[mesh.uv_triangles], coordinates[np.array(FACES) - 1])


def interleave(form: str) -> str:
    """Objects, each with its own vertices before its faces, which count back from there."""
    return (
        "o one\n" + lines("v", VERTICES[:4]) + lines("vt", COORDINATES[:4]) + "g left\n"
        f"f {form.format(-4)} {form.format(-3)} {form.format(-2)}\n"
        f"f {form.format(-4)} {form.format(-2)} {form.format(-1)}\n"
        "o two\ng\n" + lines("v", VERTICES[4:]) + lines("vt", COORDINATES[4:]) + "s off\n"
        f"f {form.format(-2)} {form.format(-3)} {form.format(-1)}\n"
    )


MAPPED = {
    "v/vt": PLAIN,
    "v/vt/vn": V + VT + VN + faces("{0}/{0}/{0}"),
    "v/vt/": V + VT + faces("{0}/{0}/"),
    "negative v/vt": V + VT + faces("{n}/{n}"),
    "negative v/vt/vn": V + VT + VN + faces("{n}/{n}/{n}"),
    "negative vt": V + VT + faces("{0}/{n}"),
    "positive and negative": V + VT + faces("{0}/{0}").replace("3/3", "-3/-3"),
    "interleaved objects": interleave("{0}/{0}"),
    "faces before vertices": faces("{0}/{0}") + VT + V,
    "vt with w": V + lines("vt", tuple(f"{each} 0" for each in COORDINATES)) + faces("{0}/{0}"),
}
UNMAPPED = {
    "v": BARE,
    "v//vn": V + VN + faces("{0}//{0}"),
    "v//": V + faces("{0}//"),
    "negative v": V + faces("{n}"),
    "negative v//vn": V + VN + faces("{n}//{n}"),
    "normals that are not there": V + faces("{0}//{0}"),
    "interleaved objects": interleave("{0}"),
    "several vertex blocks": interleave("{0}").replace("o two", "o zwei\nmg 1 2\nlod 3"),
    "fo": BARE.replace("f ", "fo "),
    "upper case": BARE.upper(),
    "plus signs": V + faces("+{0}"),
    "colours": lines("v", tuple(f"{each} 0.8 0.5 0.4" for each in VERTICES)) + faces("{0}"),
    "some colours": BARE.replace("2 2 1", "2 2 1 0.8 0.5 0.4"),
    "colours and alpha": BARE.replace("2 2 1", "2 2 1 0.8 0.5 0.4 1"),
    "w": lines("v", tuple(f"{each} 1.0" for each in VERTICES)) + faces("{0}"),
    "scientific": BARE.replace("2 2 1", "2.0e+00 .2E1 +100e-2"),
    "points without zeros": BARE.replace("2 2 1", "2. 2. 1."),
    "points and lines": BARE + "p 1 2\nl 1 2 3\nl 1/1 2/2\n",
    "unused vertices": BARE + "v 7 7 7\nv 8 8 8\n",
    "groups in any order": BARE.replace("f 1 3", "s 1\ng a b\no c\nusemtl (null)\ng\nf 1 3"),
    "quads": V + "f 1 2 3 4\nf 4 3 5\n",
}
WRITINGS = {
    "tabs": lambda text: text.replace(" ", "\t"),
    "tab after the keyword": lambda text: text.replace("v ", "v\t").replace("f ", "f\t"),
    "double spaces": lambda text: text.replace(" ", "   "),
    "indented": lambda text: "".join(f"  {line}\n" for line in text.splitlines()),
    "indented with tabs": lambda text: "".join(f"\t{line}\n" for line in text.splitlines()),
    "faces indented": lambda text: text.replace("f ", "  f "),
    "trailing spaces": lambda text: text.replace("\n", " \t \n"),
    "CR": lambda text: text.replace("\n", "\r"),
    "CR LF": lambda text: text.replace("\n", "\r\n"),
    "CR CR LF": lambda text: text.replace("\n", "\r\r\n"),
    "mixed line ends": lambda text: text.replace("\n", "\r\n", 3).replace("\nf", "\r\nf", 1),
    "no line end at the end": lambda text: text.rstrip("\n"),
    "end of file of DOS": lambda text: text + "\x1a",
    "blank lines": lambda text: text.replace("\n", "\n\n \n"),
    "continued": lambda text: text.replace(" ", " \\\n"),
    "continued, CR LF": lambda text: text.replace(" ", " \\\r\n"),
    "continued and indented": lambda text: text.replace(" ", " \\\n    "),
    "comments": lambda text: text.replace("\n", " # a comment\n").replace("f", "# f 1 1 1\nf", 1),
    "comments that end with a back-slash": lambda text: text.replace("\n", " # C:\\\n"),
    "indented comments": lambda text: text.replace("\n", "\n   # v 9 9 9\n"),
    "byte order mark": lambda text: b"\xef\xbb\xbf" + text.encode(),
    "UTF-16": lambda text: text.encode("utf-16"),
    "Latin-1": lambda text: f"# Größe\no Köpfchen\n{text}".encode("latin-1"),
    "UTF-8": lambda text: f"# 顔\no 顔\ng ☺\n{text}".encode(),
    "GB 18030": lambda text: f"o 脸\n{text}".encode("gb18030"),
}


@pytest.mark.parametrize("kind", MAPPED)
def test_indices_of_texture_coordinates(tmp_path: Path, kind: str) -> None:
    assert_plain(read(tmp_path, MAPPED[kind]), True)


@pytest.mark.parametrize("kind", UNMAPPED)
def test_indices_and_vertices(tmp_path: Path, kind: str) -> None:
    assert_plain(read(tmp_path, UNMAPPED[kind]), False)


@pytest.mark.parametrize("kind", WRITINGS)
@pytest.mark.parametrize("text", ["v/vt", "negative v/vt/vn", "interleaved objects"])
def test_lines(tmp_path: Path, kind: str, text: str) -> None:
    assert_plain(read(tmp_path, WRITINGS[kind](MAPPED[text])), True)


@pytest.mark.parametrize("kind", ["tabs", "indented", "CR", "continued", "comments"])
@pytest.mark.parametrize("text", UNMAPPED)
def test_lines_without_texture_coordinates(tmp_path: Path, kind: str, text: str) -> None:
    if not (text == "upper case" and kind == "comments"):
        assert_plain(read(tmp_path, WRITINGS[kind](UNMAPPED[text])), False)


def test_repeated_vertices_are_one(tmp_path: Path) -> None:
    twice = V + V + "f 1 2 3\nf 6 8 9\nf 4 8 10\n"
    assert_plain(read(tmp_path, twice), False)


def test_the_names_of_files_may_be_anything(tmp_path: Path) -> None:
    for name in ("Köpfchen 1.obj", "顔.obj", "100%.obj", "a#b.OBJ", "a'b.Obj"):
        assert_plain(read(tmp_path, PLAIN, name), True)


def test_a_material_at_every_face(tmp_path: Path) -> None:
    rows = faces("{0}/{0}").splitlines()
    text = V + VT + "".join(f"usemtl m{i % 2}\n{row}\n" for i, row in enumerate(rows))
    mesh = read(tmp_path, text)
    assert mesh.uv is not None and mesh.uv_triangles is not None
    assert sorted(mesh.triangles.tolist()) == sorted((np.array(FACES) - 1).tolist())
    drawn = np.array([row.split() for row in COORDINATES], float)[mesh.triangles]
    assert np.array_equal(mesh.uv[mesh.uv_triangles], drawn)


@pytest.mark.parametrize("spelling", ["nan", "NaN", "-nan", "nan(ind)", "1.#QNAN", "-1.#IND00"])
def test_a_vertex_that_is_not_a_number_stays_one(tmp_path: Path, spelling: str) -> None:
    mesh = read(tmp_path, BARE.replace("2 2 1", f"2 {spelling} 1"))
    vertices = np.array([row.split() for row in VERTICES], float)
    vertices[2, 1] = np.nan
    drawn = vertices[np.array(FACES) - 1]
    assert np.array_equal(mesh.vertices[mesh.triangles], drawn, equal_nan=True)


POLYGONS = {
    "dart": [(0, 0), (4, 0), (4, 4), (3, 1)],
    "L": [(0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2)],
    "U": [(0, 0), (3, 0), (3, 3), (2, 3), (2, 1), (1, 1), (1, 3), (0, 3)],
    "star": [
        (round(far * np.cos(turn), 6), round(far * np.sin(turn), 6))
        for far, turn in zip([2, 1] * 5, np.arange(10) * np.pi / 5, strict=True)
    ],
    "comb": [(0, 0), (5, 0), (5, 3), (4, 1), (3, 3), (2, 1), (1, 3)],
    "corner in an edge": [(0, 0), (2, 0), (4, 0), (4, 4), (0, 4)],
}


@pytest.mark.parametrize("reverse", [False, True])
@pytest.mark.parametrize("turn", range(4))
@pytest.mark.parametrize("name", POLYGONS)
def test_polygons_are_covered_once(tmp_path: Path, name: str, turn: int, reverse: bool) -> None:
    """Triangles of one orientation whose areas sum up to the polygon's do not overlap."""
    corners = POLYGONS[name][turn:] + POLYGONS[name][:turn]
    corners = corners[::-1] if reverse else corners
    text = "".join(f"v {x} {y} {0.5 * x - y}\n" for x, y in corners)
    mesh = read(tmp_path, text + "f " + " ".join(map(str, range(1, len(corners) + 1))) + "\n")
    x, y = np.array(corners, float).T
    area = (x * np.roll(y, -1) - np.roll(x, -1) * y).sum() / 2
    a, b, c = np.moveaxis(mesh.vertices[mesh.triangles][..., :2], 1, 0)
    (p, q), (r, s) = (b - a).T, (c - a).T
    signed = (p * s - q * r) / 2
    assert len(mesh.triangles) == len(corners) - 2
    assert signed.sum() == pytest.approx(area) and (signed * np.sign(area) > 0).all()


FAULTS = {
    "index 0": (V + "f 0 1 2\n", "line 6 has a face with vertex 0"),
    "beyond the vertices": (V + "f 1 2 3\nf 1 2 6\n", "line 7 has a face with vertex 6"),
    "before the first": (V + "f -6 1 2\n", "line 6 has a face with vertex -6, and 5 come before"),
    "back from its line": ("f -1 -2 -3\n" + V, "line 1 has a face with vertex -1, and 0 come"),
    "vt 0": (V + VT + "f 1/0 2/1 3/2\n", "line 11 has a face with texture coordinate 0"),
    "vt beyond": (V + VT + "f 1/1 2/2 3/6\n", "line 11 has a face with texture coordinate 6"),
    "vt before": (V + VT + "f 1/-6 2/2 3/3\n", "line 11 has a face with texture coordinate -6"),
    "vt missing": (V + "f 1/1 2/2 3/3\n", "line 6 has a face with texture coordinate 1"),
    "vt at some corners": (V + VT + "f 1/1 2 3/3\n", "line 11 has a face with .* some"),
    "too large for 64 bits": (V + f"f 1 2 {10**30}\n", "line 6 has a face with vertex 9"),
    "fractions": (V + "f 1.0 2.0 3.0\n", "line 6 is a face that cannot be read"),
    "a word": (V + "f 1 2 x\n", "line 6 is a face that cannot be read"),
    "slashes apart": (V + "f 1 / 1 2 3\n", "line 6 is a face that cannot be read"),
    "four indices": (V + "f 1/1/1/1 2/2/2/2 3/3/3/3\n", "line 6 is a face that cannot be read"),
    "a wrapped line": (V + "f 1 2\n3\n", "line 7 begins with no word"),
    "two coordinates": ("v 1 2\n" + V, "line 1 has a vertex with fewer than three"),
    "decimal commas": (V + "v 0,5 0,5 0,5\n", "line 6 has '0,5', with a comma"),
    "a word in a vertex": (V + "v 0 zero 0\n", "line 6 has 'zero', where a number belongs"),
    "an empty vt": (V + "vt\n", "line 6 has a texture coordinate without a number"),
    "another file": (V + "call b.obj\n", "line 6 takes in another file"),
    "a curved surface": (V + "surf 0 1 0 1 1 2 3 4\n", "line 6 has a curved surface"),
    "a texture by usemap": (V + "usemap skin\n", "line 6 names a texture by usemap"),
    "a web page": ("<!DOCTYPE html>\n", "line 1 begins with no word"),
    "no text": ("L\1\4\0" * 9, "it is not a text file"),
    "lines only": (V + "l 1 2\n", "has no faces, only 5 points"),
    "nothing": ("", "has no faces, only 0 points"),
}


@pytest.mark.parametrize("kind", FAULTS)
def test_faults_are_named_with_their_line(tmp_path: Path, kind: str) -> None:
    text, fault = FAULTS[kind]
    with pytest.raises(InputError, match=rf"a\.obj .*{fault}"):
        read(tmp_path, text)


def test_the_line_is_that_of_the_file_where_lines_are_continued(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="line 9 has a face with vertex 7"):
        read(tmp_path, "v 0 \\\r\n0 \\\r\n0\r\n" + V.replace("\n", "\r\n") + "f 1 2 7\r\n")


def test_what_is_passed_over_is_said(tmp_path: Path) -> None:
    mesh = read(tmp_path, BARE.replace("v ", "vcolor 1 1 1\nv ", 1) + "f 1 2\n")
    assert_plain(mesh, False)
    assert any("'vcolor' (from line 1)" in note for note in mesh.notes)
    assert any("1 faces with fewer than three corners" in note for note in mesh.notes)


def test_random_writings_of_a_mesh_are_the_mesh(tmp_path: Path) -> None:
    """Several objects, and indices of both signs, all at random."""
    rng = random.Random(0)
    for _ in range(30):
        count, text, drawn = 0, "", []
        for part in range(rng.randint(1, 4)):
            text += f"o part {part}\n"
            for _ in range(rng.randint(3, 6)):
                text += f"v {count} {rng.random()} {rng.random()}\n"
                count += 1
            for _ in range(rng.randint(1, 5)):
                face = rng.sample(range(count), 3)
                drawn.append(face)
                shown = [i + 1 if rng.random() < 0.5 else i - count for i in face]
                text += "f " + " ".join(map(str, shown)) + rng.choice(["\n", " \n", "\r\n"])
        mesh = read(tmp_path, text)
        assert mesh.vertices[mesh.triangles][..., 0].tolist() == drawn
