"""The parts of a PLY file, with the pictures that its header names."""

from pathlib import Path
from typing import NamedTuple

import numpy as np
from jaxtyping import Float, Int

from skinnet.errors import InputError
from skinnet.files._reading import read_file
from skinnet.mesh._face_parts import Faces, make_bare_parts, make_part
from skinnet.mesh._foreign_name import describe_absence, find_foreign_file, show_name
from skinnet.mesh._mesh_parts import MeshContent, MeshPart, check_range, refuse_points
from skinnet.mesh._ply_elements import Column, Columns, read_elements
from skinnet.mesh._ply_header import refuse_ply, split_ply
from skinnet.mesh._polygons import cut_polygons
from skinnet.mesh._texture_file import Texture, check_colour, describe_texture, open_texture

_INDICES = ("vertex_indices", "vertex_index")
_NUMBERS = ("texnumber", "texture_number", "tex_number")
_COORDINATES = (("s", "t"), ("u", "v"), ("texture_u", "texture_v"), ("texture_s", "texture_t"))


class _Ply(NamedTuple):
    """Triangles of a PLY file, and the number of each one's picture if it is stated."""

    faces: Faces
    number: Int[np.ndarray, "triangles"] | None
    textures: list[bytes]
    coloured: bool


def read_ply_content(
    path: Path, given: Texture | None = None, textured: bool = True
) -> MeshContent:
    """Read a PLY file; faces with pictures of their own (`texnumber`) are parts.

    Args:
        path: The file.
        given: A picture to use in place of those that the header names.
        textured: Read pictures.

    Raises:
        InputError: For a file that is damaged or has no triangles, and for a picture that is
            missing or cannot be used.
    """
    ply = _read(path)
    parts = make_bare_parts(ply.faces)
    notes: list[str] = []
    if not textured:
        return MeshContent(parts, notes, False, ply.faces.vertices)
    if given is not None:
        parts = [part._replace(texture=given) for part in parts]
    elif ply.textures:
        parts = _add_pictures(path, ply, parts, notes)
    if ply.coloured and all(part.texture is None for part in parts):
        notes.append(
            f"{path} has colours at its vertices, which are not read; skin is read from a texture. "
            "Bake them into one."
        )
    return MeshContent(parts, notes, bool(ply.textures), ply.faces.vertices)


def _read(path: Path) -> _Ply:
    header, body = split_ply(path, read_file(path))
    columns = read_elements(path, header, body)
    vertex, face = columns.get("vertex", {}), columns.get("face", {})
    if not all(axis in vertex for axis in "xyz"):
        raise refuse_ply(path, "its vertices have no x, y and z")
    vertices = np.stack([vertex[axis].values.astype(np.float64) for axis in "xyz"], 1)
    corners = _find_corners(path, columns)
    if corners is None or not (corners.counts >= 3).any():
        raise refuse_points(path, len(vertices))
    index = corners.values.astype(np.int64)
    check_range(path, index, len(vertices))
    cut, owner = cut_polygons(vertices[index], corners.counts)
    coordinates, at_corner = _read_coordinates(path, columns, index, corners.counts)
    uv = at_corner[cut]
    uv = np.where((uv < 0).any(1, keepdims=True), -1, uv)
    name = next((each for each in _NUMBERS if each in face), None)
    number = None if name is None else face[name].values.astype(np.int64)[owner]
    coloured = "red" in vertex or "diffuse_red" in vertex or "red" in face
    faces = Faces(vertices, coordinates, index[cut], uv)
    return _Ply(faces, number, [each for each in header.textures if each], coloured)


def _find_corners(path: Path, columns: Columns) -> Column | None:
    if any(name.startswith("tristrip") for name in columns):
        raise refuse_ply(path, "its faces are strips of triangles, and single ones are read")
    face = columns.get("face")
    if not face:
        return None
    found = next((face[name] for name in _INDICES if name in face), None)
    if found is None:
        names = ", ".join(face)
        raise refuse_ply(path, f"its faces have no {_INDICES[0]} among {names}")
    return found


def _read_coordinates(
    path: Path,
    columns: Columns,
    index: Int[np.ndarray, "corners"],
    counts: Int[np.ndarray, "faces"],
) -> tuple[Float[np.ndarray, "coordinates 2"], Int[np.ndarray, "corners"]]:
    """Read texture coordinates, and which one each corner has; -1 for none."""
    face, vertex = columns["face"], columns["vertex"]
    if "texcoord" in face:
        listed = face["texcoord"]
        mapped = listed.counts == 2 * counts
        if not (mapped | (listed.counts == 0)).all():
            raise refuse_ply(path, "it has faces with other than two texture coordinates a corner")
        coordinates = listed.values.astype(np.float64).reshape(-1, 2)
        at_corner = np.full(len(index), -1)
        at_corner[np.repeat(mapped, counts)] = np.arange(len(coordinates))
        return coordinates, at_corner
    names = next((each for each in _COORDINATES if set(each) <= set(vertex)), None)
    if names is None:
        return np.zeros((0, 2)), np.full(len(index), -1)
    return np.stack([vertex[name].values.astype(np.float64) for name in names], 1), index


def _add_pictures(path: Path, ply: _Ply, parts: list[MeshPart], notes: list[str]) -> list[MeshPart]:
    """Add the pictures that the header names; faces without texture coordinates have none."""
    names = ", ".join(show_name(name) for name in ply.textures)
    if (ply.faces.uv_triangles < 0).all():
        notes.append(f"{path} names the texture {names} and has no texture coordinates (UV).")
        return parts
    numbers = ply.number
    if len(set(ply.textures)) == 1:
        numbers = np.zeros(len(ply.faces.triangles), np.int64)
    if numbers is None:
        raise InputError(
            f"{path} names the textures {names}, and does not say which face has which; export it "
            "with one, or give the picture with --texture."
        )
    plain = [part for part in parts if part.uv is None]
    mapped = ply.faces.uv_triangles[:, 0] >= 0
    added = []
    for number in np.unique(numbers[mapped]).tolist():
        part = make_part(ply.faces, numbers == number, True)
        assert part is not None
        added.append(part._replace(texture=_read_numbered(path, ply, number, notes)))
    if plain:
        count = int((~mapped).sum())
        notes.append(f"{path}: {count:,} triangles have no texture coordinates, and are grey.")
    return added + plain


def _read_numbered(path: Path, ply: _Ply, number: int, notes: list[str]) -> Texture:
    if not 0 <= number < len(ply.textures):
        raise InputError(
            f"{path} has faces with texture {number}, and names {len(ply.textures)}, from 0; "
            "export it again, or give the picture with --texture."
        )
    name = ply.textures[number]
    found = find_foreign_file(name, [path.absolute().parent])
    if found is None:
        raise InputError(
            f"{path} names the picture {show_name(name)!r} (TextureFile), and "
            f"{describe_absence(name, path.parent)}; put it beside the mesh, or give "
            "the picture with --texture."
        )
    if found.moved:
        notes.append(
            f"{path} names {show_name(name)}, which is not there; {found.path} is taken, which has "
            "its name."
        )
    picture = open_texture(found.path)
    check_colour(picture.srgb, str(found.path))
    notes += describe_texture(picture)
    return picture.srgb
