"""Mesh files of every kind as parts."""

from dataclasses import replace
from pathlib import Path

import numpy as np

from skinnet.mesh._gltf.content import read_gltf
from skinnet.mesh._mesh_parts import (
    MeshContent,
    check_mesh_file,
    concatenate,
)
from skinnet.mesh._obj_content import read_obj_content
from skinnet.mesh._ply_content import read_ply_content
from skinnet.mesh._seams import merge_coordinates, merge_vertices
from skinnet.mesh._stl import read_stl_content
from skinnet.mesh._texture_atlas import pack_atlas
from skinnet.mesh._texture_file import Texture
from skinnet.mesh.mesh import Mesh

_READERS = {
    ".obj": read_obj_content,
    ".ply": read_ply_content,
    ".glb": read_gltf,
    ".gltf": read_gltf,
    ".stl": read_stl_content,
}


def read_content(path: Path, given: Texture | None = None, textured: bool = True) -> MeshContent:
    """Read the parts of a mesh file, in the file's frame.

    Args:
        path: The file.
        given: A picture to use in place of those that the file names, which are not read then.
        textured: Read pictures and colours.

    Raises:
        InputError: For a file that is missing, of another kind, damaged, or without triangles.
    """
    check_mesh_file(path)
    # Numbers that are too large are refused in words, and need no warning.
    with np.errstate(over="ignore", invalid="ignore"):
        return _READERS[path.suffix.lower()](path, given, textured)


def join_parts(path: Path, content: MeshContent) -> Mesh:
    """Join the parts of a file into one mesh with one texture."""
    whole = concatenate([part.geometry for part in content.parts])
    vertices, triangles = merge_vertices(whole, content.listed)
    mesh = Mesh(vertices, triangles, name=str(path), notes=tuple(content.notes))
    atlas = pack_atlas(content.parts)
    if atlas is None:
        return mesh
    uv, uv_triangles = merge_coordinates(triangles, atlas.uv, atlas.triangles)
    return replace(mesh, uv=uv, uv_triangles=uv_triangles, texture=atlas.texture)
