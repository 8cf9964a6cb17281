"""An upright face is found in pictures of it, at any size and place; another object is refused."""

import numpy as np
import pytest
import trimesh

from skinnet.errors import NoFaceError
from skinnet.mesh.mesh import Mesh
from skinnet.pipeline.initial_pose import find_initial_pose
from skinnet.shape.model_formats import load_shape_model


def test_an_upright_face_is_found_at_any_size_and_place() -> None:
    model = load_shape_model()
    alpha = np.sqrt(model.variances[:5]) * [1, -1, 1, -1, 1]
    scan = Mesh(0.1 * model.reconstruct(alpha) + [30, -5, 7], model.triangles, name="a face")
    pose = find_initial_pose(model, scan)
    assert pose.scale == pytest.approx(0.1, rel=0.1)
    assert np.abs(pose(model.mean) - scan.vertices).max() / pose.scale < 25


def test_an_object_without_a_face_is_refused() -> None:
    ball = trimesh.creation.icosphere(subdivisions=3)
    mesh = Mesh(np.array(ball.vertices), np.array(ball.faces), name="a ball")
    with pytest.raises(
        NoFaceError, match="No face was found on a ball from the front; rotate it upright"
    ):
        find_initial_pose(load_shape_model(), mesh)
