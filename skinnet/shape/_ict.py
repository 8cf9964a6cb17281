"""ICT-FaceKit's shape model (Li et al. 2020, USC ICT, MIT licence): its folder, or an .npz of it.

Modes are scaled by the standard deviation over people, so variances are one. The unit is a
centimetre. Expressions are not read.
"""

import json
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float

from skinnet.errors import InputError, _name_error
from skinnet.files._reading import MOST_TEXT, read_file
from skinnet.mesh._content import join_parts, read_content
from skinnet.mesh._obj import read_obj_positions
from skinnet.mesh._seams import match_positions, merge_coordinates
from skinnet.shape._ibug import name_ibug_point
from skinnet.shape._model_numbers import to_floats, to_indices
from skinnet.shape.model import ShapeModel

NEUTRAL = "generic_neutral_mesh.obj"
FACE_VERTEX_COUNT = 9409
"""The first vertices of the model are those of the face; head, eyes and teeth follow."""

MILLIMETRES = 10.0


def read_ict_arrays(path: Path, arrays: Mapping[str, Any], whole: bool = False) -> ShapeModel:
    """Make the model of `verts`, `id_modes`, `tris`, `tris_uv`, `uv` and `landmarks68`.

    With `whole` the head with its eyes and teeth, otherwise the face. Raises `InputError` if the
    arrays do not belong together.
    """
    modes = to_floats(arrays["id_modes"]).astype(np.float64, copy=False)
    triangles = to_indices(arrays["tris"])
    uv = to_floats(arrays["uv"]).astype(np.float64, copy=False)
    uv_triangles = to_indices(arrays["tris_uv"])
    model = ShapeModel.from_arrays(
        to_floats(arrays["verts"]).astype(np.float64, copy=False),
        modes,
        np.ones(len(modes)),
        triangles,
        uv,
        uv_triangles,
        _name_landmarks(arrays["landmarks68"]),
        MILLIMETRES,
        str(path),
    )
    # The arrays repeat equal coordinates.
    uv, uv_triangles = merge_coordinates(triangles, uv, uv_triangles)
    model = replace(model, uv=uv, uv_triangles=uv_triangles)
    count = int(arrays["face_vertex_count"])
    if not 0 < count <= len(model.mean):
        raise InputError(f"{path} states a face of {count:,} of {len(model.mean):,} vertices.")
    return model if whole else _crop_to_face(model, np.arange(len(model.mean)) < count)


def load_ict_folder(folder: Path, whole: bool = False) -> ShapeModel:
    """Load a folder FaceXModel: `NEUTRAL`, identity000.obj and so on, vertex_indices.json.

    With `whole` the head with its eyes and teeth, otherwise the face. Landmarks come from
    vertex_indices.json, whose vertex numbers belong to the same release of the meshes. Raises
    `InputError` if there are no identities, or one has another number of vertices than `NEUTRAL`.
    """
    neutral = join_parts(folder / NEUTRAL, read_content(folder / NEUTRAL, textured=False))
    listed = read_obj_positions(folder / NEUTRAL)
    files = sorted(folder.glob("identity[0-9][0-9][0-9].obj"))
    if not files:
        raise InputError(f"{folder} has {NEUTRAL}, but no identity000.obj; copy the whole folder.")
    index = match_positions(listed, neutral.vertices)
    basis = np.stack([_read_identity(file, listed)[index] for file in files]) - neutral.vertices
    model = ShapeModel.from_arrays(
        neutral.vertices,
        basis,
        np.ones(len(basis)),
        neutral.triangles,
        neutral.uv,
        neutral.uv_triangles,
        _read_landmarks(folder / "vertex_indices.json", index),
        MILLIMETRES,
        str(folder),
    )
    return model if whole else _crop_to_face(model, index < FACE_VERTEX_COUNT)


def _read_identity(
    file: Path, listed: Float[np.ndarray, "listed 3"]
) -> Float[np.ndarray, "listed 3"]:
    positions = read_obj_positions(file)
    if positions.shape != listed.shape:
        raise InputError(
            f"{file} has {len(positions):,} vertices, and {NEUTRAL} has {len(listed):,}; "
            "the files are of different releases or cut short."
        )
    return positions


def _read_landmarks(path: Path, index: np.ndarray) -> dict[str, int]:
    if not path.is_file():
        return {}
    try:
        listed = json.loads(read_file(path, MOST_TEXT))["idx_to_landmark_verts"]
        place = {int(vertex): number for number, vertex in enumerate(index)}
        return _name_landmarks([place[vertex] for vertex in listed])
    except (ValueError, LookupError, TypeError) as error:
        raise InputError(
            f"{path} has no usable landmarks ({_name_error(error)}); copy it again, or remove it."
        ) from error


def _name_landmarks(vertices: Any) -> dict[str, int]:
    return {name_ibug_point(number): int(vertex) for number, vertex in enumerate(vertices)}


def _crop_to_face(model: ShapeModel, keep: np.ndarray) -> ShapeModel:
    """Keep the face. Other parts share its vertices, but lie in other tiles of the texture."""
    if model.uv is not None and model.uv_triangles is not None:
        own = (model.uv[model.uv_triangles] <= 1).all((1, 2))
        triangles, uv_triangles = model.triangles[own], model.uv_triangles[own]
        model = replace(model, triangles=triangles, uv_triangles=uv_triangles)
    face = model.crop(keep)
    if not len(face.triangles):
        raise InputError(f"{model.name} has no triangle of a face; copy it again.")
    return face
