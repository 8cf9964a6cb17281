"""The parts of a PLY file, with the pictures that its header names."""

from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Int

from skinnet.errors import InputError
from skinnet.mesh._foreign_name import find_foreign_file, show_name
from skinnet.mesh._mesh_parts import MeshContent, MeshPart, convert_part, load_geometries
from skinnet.mesh._ply_header import PlyHeader, read_ply_header
from skinnet.mesh._texture_file import Texture, check_colour, describe_texture, open_texture

_NUMBERS = ("texnumber", "texture_number", "tex_number")


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
    header = read_ply_header(path)
    geometries = load_geometries(path, BytesIO(header.content))
    parts = [convert_part(path, each) for each in geometries]
    notes: list[str] = []
    if textured:
        _check_coordinates(path, header, parts, given, notes)
    if textured and given is not None:
        parts = [part._replace(texture=given) for part in parts]
    elif textured and header.textures and all(part.uv is not None for part in parts):
        pairs = zip(parts, geometries, strict=True)
        parts = [one for part, each in pairs for one in _split(path, header, part, each, notes)]
    return MeshContent(parts, notes, bool(header.textures), np.zeros((0, 3)))


def _check_coordinates(
    path: Path,
    header: PlyHeader,
    parts: list[MeshPart],
    given: Texture | None,
    notes: list[str],
) -> None:
    face, vertex = (header.properties.get(name, []) for name in ("face", "vertex"))
    if all(part.uv is not None for part in parts):
        return
    if "texcoord" in face:
        raise InputError(
            f"{path} has texture coordinates at faces that are not all triangles, which are not "
            "read; export it as triangles, or as OBJ."
        )
    if header.textures and given is None:
        names = ", ".join(show_name(name) for name in header.textures)
        notes.append(f"{path} names the texture {names} and has no texture coordinates (UV).")
    elif "red" in vertex:
        notes.append(
            f"{path} has colours at its vertices, which are not read; skin is read from a texture. "
            "Bake them into one."
        )


def _split(
    path: Path, header: PlyHeader, part: MeshPart, geometry: Any, notes: list[str]
) -> list[MeshPart]:
    """Split a part by the pictures of its faces."""
    numbers = _read_numbers(path, header, geometry, len(part.geometry.triangles))
    parts = []
    for number in np.unique(numbers).tolist():
        if not 0 <= number < len(header.textures):
            raise InputError(
                f"{path} has faces with texture {number}, and names {len(header.textures)}; export "
                "it again."
            )
        texture = _read_texture(path, header.textures[number], notes)
        triangles = part.geometry.triangles[numbers == number]
        parts.append(
            part._replace(geometry=part.geometry._replace(triangles=triangles), texture=texture)
        )
    return parts


def _read_numbers(
    path: Path, header: PlyHeader, geometry: Any, count: int
) -> Int[np.ndarray, "triangles"]:
    """Read which picture each triangle has."""
    if len(set(header.textures)) == 1:
        return np.zeros(count, np.int64)
    faces = geometry.metadata["_ply_raw"]["face"]["data"]
    name = next((each for each in _NUMBERS if each in header.properties["face"]), None)
    numbers = None if name is None else np.asarray(faces[name]).ravel()
    if numbers is None or len(numbers) != count:
        names = ", ".join(show_name(each) for each in header.textures)
        raise InputError(
            f"{path} names the textures {names}, and does not say which face has which; export it "
            "with one, or give the picture with --texture."
        )
    return numbers.astype(np.int64)


def _read_texture(path: Path, name: bytes, notes: list[str]) -> Texture:
    found = find_foreign_file(name, [path.absolute().parent])
    if found is None:
        raise InputError(
            f"{path} names the picture {show_name(name)!r} (TextureFile), and there is no such "
            "file; put it beside the mesh, or give the picture with --texture."
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
