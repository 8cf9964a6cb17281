"""A shape model reconstructs faces, and is truncated and cropped."""

import numpy as np
import pytest
from small_meshes import small_model

from skinnet.errors import InputError
from skinnet.shape.model import ShapeModel


def test_more_modes_than_there_are_is_refused() -> None:
    for modes in (0, 4):
        with pytest.raises(InputError, match=f"small has 3 modes, and {modes} are asked for"):
            small_model().truncate(modes)


def test_cropping_keeps_what_lies_wholly_on_it() -> None:
    model = small_model()
    keep = model.mean[:, 1] > -1
    part = model.crop(keep)
    assert len(part.mean) == keep.sum() == 35 and len(part.triangles) == 48
    assert np.allclose(part.reconstruct(np.ones(3)), model.reconstruct(np.ones(3))[keep])
    assert set(part.landmarks) == {"right_eye_outer", "left_eye_outer", "nose_tip"}
    for name, vertex in part.landmarks.items():
        assert np.array_equal(part.mean[vertex], model.mean[model.landmarks[name]])
    corners = part.mean[part.triangles][..., 1] / 180 + 0.5
    assert np.allclose(part.uv[part.uv_triangles][..., 1], corners)


def test_arrays_that_belong_together_make_a_model() -> None:
    model = small_model()
    same = ShapeModel.from_arrays(model.mean, model.basis, model.variances, model.triangles)
    assert np.array_equal(same.reconstruct(np.ones(2)), model.reconstruct(np.ones(2)))
    with pytest.raises(
        InputError, match=r"a file is not a usable shape model: its unit is 0\.0 milli"
    ):
        ShapeModel.from_arrays(
            model.mean,
            model.basis,
            model.variances,
            model.triangles,
            millimetres=0.0,
            name="a file",
        )


def test_missing_coefficients_are_zero() -> None:
    model = small_model()
    assert np.array_equal(model.reconstruct(np.zeros(0)), model.mean)
    padded = np.array([2.0, 0, 0])
    assert np.allclose(model.build_mesh(padded[:1]).vertices, model.reconstruct(padded))
