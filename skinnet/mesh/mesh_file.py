"""Meshes read from and written to files."""

from pathlib import Path

import numpy as np
from PIL import Image

from skinnet.errors import InputError
from skinnet.files import written_together
from skinnet.mesh._mesh_parts import MeshPart, concatenate, read_obj_positions, read_parts
from skinnet.mesh._seams import merge_coordinates, merge_vertices
from skinnet.mesh._texture_atlas import Page, pack_atlas
from skinnet.mesh._texture_file import Texture, picture_beside, read_texture
from skinnet.mesh.mesh import Mesh


def read_mesh(path: Path, texture: Path | None = None) -> Mesh:
    """A mesh from an OBJ, PLY, glTF, GLB or STL file, its parts joined.

    Vertices at exactly the same position become one, in the order of the file (numbers of vertices
    count these), and those without a triangle are left out; a vertex on a seam keeps its several
    texture coordinates. The texture is `texture`, or what the materials name, or the picture in the
    mesh's folder that bears its name, or the only one there; pixels stay as they lie in the file
    (`read_texture`). Pictures of several parts are laid side by side, and a part without one gets
    its material's colour.

    Raises `InputError` for a file that is missing, of another kind, damaged, or without triangles.
    """
    path = Path(path)
    parts = read_parts(path)
    listed = read_obj_positions(path) if path.suffix.lower() == ".obj" else np.zeros((0, 3))
    vertices, triangles = merge_vertices(concatenate([part.corners for part in parts]), listed)
    atlas = pack_atlas(_pages(parts, texture, picture_beside(path)))
    if atlas is None:
        return Mesh(vertices, triangles, name=str(path))
    uv, uv_triangles = merge_coordinates(triangles, atlas.uv, atlas.triangles)
    return Mesh(vertices, triangles, uv, uv_triangles, atlas.picture, str(path))


def write_mesh(path: Path, mesh: Mesh) -> None:
    """Write a mesh as OBJ, with an MTL and a PNG beside it where it has a texture, or as PLY.

    The files appear together or not at all. Raises `InputError` for another suffix.
    """
    path = Path(path)
    writers = {".obj": _obj, ".ply": _ply}
    if path.suffix.lower() not in writers:
        raise InputError(f"Meshes are written as .obj or .ply; got {path}.")
    picture = path.with_suffix(".png")
    with written_together() as beside:
        lines = writers[path.suffix.lower()](path, mesh)
        beside(path).write_bytes(lines)
        if mesh.texture is not None and mesh.uv is not None:
            Image.fromarray(mesh.texture).save(beside(picture), "PNG")
            if path.suffix.lower() == ".obj":
                material = f"newmtl skin\nKd 1 1 1\nmap_Kd {picture.name}\n"
                beside(path.with_suffix(".mtl")).write_text(material, encoding="utf-8")


def _pages(parts: list[MeshPart], given: Path | None, beside: Path | None) -> list[Page]:
    pictures: list[Texture | None] = [part.picture for part in parts]
    missing = all(picture is None for picture in pictures)
    if given is not None:
        pictures = [read_texture(Path(given))] * len(parts)
    elif missing and beside is not None and any(part.uv is not None for part in parts):
        pictures = [read_texture(beside)] * len(parts)
    return [
        Page(part.corners.triangles, part.uv, picture, part.colour)
        for part, picture in zip(parts, pictures, strict=True)
    ]


def _obj(path: Path, mesh: Mesh) -> bytes:
    lines = [f"v {x:.9g} {y:.9g} {z:.9g}" for x, y, z in mesh.vertices.tolist()]
    corners = (mesh.triangles + 1).tolist()
    if mesh.uv is None or mesh.uv_triangles is None:
        lines += [f"f {a} {b} {c}" for a, b, c in corners]
        return ("\n".join(lines) + "\n").encode()
    if mesh.texture is not None:
        lines = [f"mtllib {path.with_suffix('.mtl').name}", *lines, "usemtl skin"]
    lines += [f"vt {u:.9g} {v:.9g}" for u, v in mesh.uv.tolist()]
    pairs = zip(corners, (mesh.uv_triangles + 1).tolist(), strict=True)
    lines += [f"f {a}/{i} {b}/{j} {c}/{k}" for (a, b, c), (i, j, k) in pairs]
    return ("\n".join(lines) + "\n").encode()


def _ply(path: Path, mesh: Mesh) -> bytes:
    """Binary, with the texture coordinates of each face's corners as MeshLab writes them."""
    face: list[tuple[str, str, tuple[int, ...]]]
    face = [("count", "u1", ()), ("corners", "<i4", (3,))]
    textured = mesh.texture is not None and mesh.uv is not None
    header = [
        "ply",
        "format binary_little_endian 1.0",
        *([f"comment TextureFile {path.with_suffix('.png').name}"] * textured),
        f"element vertex {len(mesh.vertices)}",
        *(f"property double {axis}" for axis in "xyz"),
        f"element face {len(mesh.triangles)}",
        "property list uchar int vertex_indices",
    ]
    if mesh.uv is not None:
        face += [("values", "u1", ()), ("uv", "<f4", (3, 2))]
        header += ["property list uchar float texcoord"]
    faces = np.zeros(len(mesh.triangles), np.dtype(face))
    faces["count"], faces["corners"] = 3, mesh.triangles
    if mesh.uv is not None:
        faces["values"], faces["uv"] = 6, mesh.uv[mesh.uv_triangles]
    text = "\n".join([*header, "end_header", ""])
    return text.encode() + mesh.vertices.astype("<f8").tobytes() + faces.tobytes()
