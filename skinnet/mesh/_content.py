"""Mesh files of every kind as parts."""

from pathlib import Path

import numpy as np

from skinnet.mesh._gltf.content import read_gltf
from skinnet.mesh._mesh_parts import (
    MeshContent,
    check_mesh_file,
    read_obj_positions,
    read_parts,
)
from skinnet.mesh._texture_file import Texture

_GLTF = (".glb", ".gltf")


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
    if path.suffix.lower() in _GLTF:
        return read_gltf(path, given, textured)
    parts = read_parts(path)
    if given is not None:
        parts = [part._replace(texture=given) for part in parts]
    listed = read_obj_positions(path) if path.suffix.lower() == ".obj" else np.zeros((0, 3))
    named = any(part.texture is not None for part in parts)
    return MeshContent(parts, [], named, listed)
