"""A shape model from the files of registered meshes."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from jaxtyping import Float, Int

from skinnet.errors import InputError
from skinnet.mesh._content import read_content
from skinnet.mesh._mesh_parts import MeshPart, concatenate
from skinnet.mesh._obj import read_obj_positions
from skinnet.mesh._seams import match_positions, merge_coordinates
from skinnet.mesh._texture_atlas import pack_atlas
from skinnet.mesh._topology import weld
from skinnet.mesh.mesh import Mesh
from skinnet.shape.model import ShapeModel
from skinnet.shape.registered_meshes import _check_correspondence, build_shape_model


def load_registered_meshes(
    files: Sequence[Path], align: bool = True, millimetres: float | None = None, name: str = "model"
) -> ShapeModel:
    """Build a model of the meshes in these files (OBJ, PLY, glTF or STL).

    Vertices keep the order of the first file; those that coincide in every file are merged. Raises
    `InputError` naming the file that cannot be read, or does not correspond to the first.
    """
    if not files:
        raise InputError(f"{name} has no meshes; give .obj, .ply, .glb or .gltf files.")
    parts = [read_content(Path(file), textured=False).parts for file in files]
    whole = [concatenate([part.geometry for part in each]) for each in parts]
    meshes = [
        Mesh(geometry.vertices, geometry.triangles, name=str(file))
        for file, geometry in zip(files, whole, strict=True)
    ]
    _check_correspondence(meshes)
    faces = np.stack([mesh.vertices for mesh in meshes])
    used, triangles = _merge_vertices(Path(files[0]), faces, meshes[0].triangles)
    uv, uv_triangles = _merge_coordinates(parts[0], triangles)
    merged = [
        Mesh(face[used], triangles, uv, uv_triangles, name=str(file))
        for file, face in zip(files, faces, strict=True)
    ]
    return build_shape_model(merged, None, align, millimetres, name)


def _merge_vertices(
    first: Path,
    faces: Float[np.ndarray, "subjects vertices 3"],
    triangles: Int[np.ndarray, "triangles 3"],
) -> tuple[Int[np.ndarray, "merged"], Int[np.ndarray, "triangles 3"]]:
    """Merge vertices at one place in the first face and in the mean; keep the file's order."""
    places = [weld(faces[0]), weld(faces.mean(0)), np.zeros(faces.shape[1])]
    joint = weld(np.stack(places, 1).astype(np.float64))
    used, place = np.unique(joint[triangles], return_inverse=True)
    if first.suffix.lower() != ".obj":
        return used, place.reshape(-1, 3)
    order = np.argsort(match_positions(read_obj_positions(first), faces[0][used]), kind="stable")
    return used[order], np.argsort(order)[place].reshape(-1, 3)


def _merge_coordinates(
    parts: list[MeshPart], triangles: Int[np.ndarray, "triangles 3"]
) -> tuple[Float[np.ndarray, "points 2"] | None, Int[np.ndarray, "triangles 3"] | None]:
    atlas = pack_atlas([part._replace(texture=None) for part in parts])
    if atlas is None:
        return None, None
    return merge_coordinates(triangles, atlas.uv, atlas.triangles)
