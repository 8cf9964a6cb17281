"""Mesh files: OBJ, PLY, glTF and STL are read, OBJ and PLY are written."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from skinnet.errors import InputError
from skinnet.files import write_together
from skinnet.images._png_file import write_png
from skinnet.mesh._content import join_parts, read_content
from skinnet.mesh._mesh_parts import MeshContent
from skinnet.mesh._texture_beside import find_texture_beside
from skinnet.mesh._texture_file import Texture, check_colour, describe_texture, open_texture
from skinnet.mesh.mesh import Mesh


def read_mesh(path: Path, texture: Path | None = None) -> Mesh:
    r"""Read a mesh from an OBJ, PLY, glTF, GLB or STL file and join its parts.

    Vertices at exactly the same position are merged, and those without a triangle are dropped; the
    order is that of the file. A vertex on a seam keeps its several texture coordinates.

    The texture is `texture`, else what the materials name. Where they name none it is the picture
    in the mesh's folder with the mesh's name, or the only one there if its name says that it is
    colour, such as albedo.jpg. An EXIF orientation is not applied, since texture coordinates refer
    to the stored rows and columns. If parts have different pictures, these are placed side by side;
    a part whose material names none gets the material's colour. What was assumed is in the mesh's
    notes.

    Args:
        path: The mesh file.
        texture: A picture to use in place of the materials'.

    Returns:
        The mesh, named after the file.

    Raises:
        InputError: For a file that is missing, of another kind, damaged, or without triangles, and
            for a texture that a material names and that is missing or is no picture of colour.

    Example:
        >>> from pathlib import Path
        >>> from tempfile import TemporaryDirectory
        >>> from skinnet.mesh import read_mesh
        >>> with TemporaryDirectory() as folder:
        ...     path = Path(folder) / "triangle.obj"
        ...     _ = path.write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
        ...     read_mesh(path).triangles
        array([[0, 1, 2]])
    """
    path = Path(path)
    if texture is None:
        content = _add_texture(path, read_content(path))
    else:
        given, notes = _read_picture(Path(texture))
        content = read_content(path, given)
        content = content._replace(notes=[*content.notes, *notes])
    return join_parts(path, content)


def write_mesh(path: Path, mesh: Mesh, text: Mapping[str, str] | None = None) -> None:
    """Write a mesh as OBJ or PLY, with its texture as a PNG beside it.

    The files (an OBJ has an MTL too) appear together or not at all.

    Args:
        path: The file, with suffix .obj or .ply.
        mesh: The mesh.
        text: What to write into the files by keyword, as comments and as tEXt chunks of the PNG.

    Raises:
        InputError: For another suffix, or if a file cannot be written.

    Example:
        >>> import numpy as np
        >>> from pathlib import Path
        >>> from tempfile import TemporaryDirectory
        >>> from skinnet.mesh import Mesh, write_mesh
        >>> with TemporaryDirectory() as folder:
        ...     write_mesh(Path(folder) / "a.obj", Mesh(np.eye(3), np.array([[0, 1, 2]])))
        ...     print((Path(folder) / "a.obj").read_text())
        v 1 0 0
        v 0 1 0
        v 0 0 1
        f 1 2 3
        <BLANKLINE>
    """
    path = Path(path)
    writers = {".obj": _format_obj, ".ply": _format_ply}
    text = text or {}
    if path.suffix.lower() not in writers:
        raise InputError(f"Meshes are written as .obj or .ply; got {path}.")
    picture = path.with_suffix(".png")
    with write_together() as beside:
        beside(path).write_bytes(writers[path.suffix.lower()](path, mesh, list(text.values())))
        if mesh.texture is not None and mesh.uv is not None:
            write_png(beside(picture), mesh.texture, text)
            if path.suffix.lower() == ".obj":
                comments = "".join(f"# {line}\n" for line in text.values())
                material = f"{comments}newmtl skin\nKd 1 1 1\nmap_Kd {picture.name}\n"
                beside(path.with_suffix(".mtl")).write_text(material, encoding="utf-8")


def _add_texture(path: Path, content: MeshContent) -> MeshContent:
    """Add the picture beside the mesh if the mesh names none."""
    mapped = any(part.uv is not None for part in content.parts)
    textured = any(part.texture is not None for part in content.parts)
    if content.names_pictures or textured or not mapped:
        return content
    found, note = find_texture_beside(path)
    if found is None:
        return content._replace(notes=[*content.notes, note])
    texture, notes = _read_picture(found)
    parts = [part._replace(texture=texture) for part in content.parts]
    return content._replace(parts=parts, notes=[*content.notes, note, *notes])


def _read_picture(path: Path) -> tuple[Texture, list[str]]:
    picture = open_texture(path)
    check_colour(picture.srgb, str(path))
    return picture.srgb, describe_texture(picture)


def _format_obj(path: Path, mesh: Mesh, comments: list[str]) -> bytes:
    head = [f"# {line}" for line in comments]
    lines = [f"v {x:.9g} {y:.9g} {z:.9g}" for x, y, z in mesh.vertices.tolist()]
    corners = (mesh.triangles + 1).tolist()
    if mesh.uv is None or mesh.uv_triangles is None:
        lines += [f"f {a} {b} {c}" for a, b, c in corners]
        return ("\n".join(head + lines) + "\n").encode()
    if mesh.texture is not None:
        lines = [f"mtllib {path.with_suffix('.mtl').name}", *lines, "usemtl skin"]
    lines += [f"vt {u:.9g} {v:.9g}" for u, v in mesh.uv.tolist()]
    pairs = zip(corners, (mesh.uv_triangles + 1).tolist(), strict=True)
    lines += [f"f {a}/{i} {b}/{j} {c}/{k}" for (a, b, c), (i, j, k) in pairs]
    return ("\n".join(head + lines) + "\n").encode()


def _format_ply(path: Path, mesh: Mesh, comments: list[str]) -> bytes:
    """Format as binary PLY, with texture coordinates of face corners in MeshLab's layout."""
    face: list[tuple[str, str, tuple[int, ...]]]
    face = [("count", "u1", ()), ("corners", "<i4", (3,))]
    textured = mesh.texture is not None and mesh.uv is not None
    header = [
        "ply",
        "format binary_little_endian 1.0",
        *(f"comment {line}" for line in comments),
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
