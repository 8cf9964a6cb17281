"""The warp by the face mesh is scikit-image's, exact for affine maps, and refuses other poses."""

import numpy as np
import pytest
from skimage.transform import PiecewiseAffineTransform

from skinnet.errors import InputError
from skinnet.images import find_faces
from skinnet.inference._comparison.face_warp import FaceWarp, measure_face, sample_at

NAMES = ("a.jpg", "b.jpg")


@pytest.fixture(scope="module")
def landmarks(astronaut: np.ndarray) -> np.ndarray:
    return find_faces(astronaut)[0].landmarks


def turn(landmarks: np.ndarray, degrees: float) -> np.ndarray:
    """Landmarks of a face that is turned to the side, as if it were half a ball."""
    middle, radius = landmarks.mean(0), 0.6 * measure_face(landmarks)
    flat = (landmarks - middle) / radius
    depth = np.sqrt(np.maximum(1 - (flat**2).sum(-1), 0))
    angle = np.radians(degrees)
    x = np.cos(angle) * flat[:, 0] + np.sin(angle) * depth
    return middle + radius * np.stack([x, flat[:, 1]], -1)


def test_an_affine_map_is_exact_inside_and_outside(landmarks: np.ndarray) -> None:
    matrix, shift = np.array([[1.2, -0.3], [0.25, 0.9]]), np.array([30, -12])
    warp = FaceWarp.between(landmarks, landmarks @ matrix.T + shift)
    points = np.random.default_rng(0).uniform(-100, 600, (200, 2))
    np.testing.assert_allclose(warp.map(points), points @ matrix.T + shift, atol=0.01)
    assert warp.bend < 1e-4


def test_it_is_the_piecewise_affine_transform_of_scikit_image(landmarks: np.ndarray) -> None:
    turned = turn(landmarks, 8)
    warp = FaceWarp.between(landmarks, turned)
    oracle = PiecewiseAffineTransform.from_estimate(landmarks[:468], turned[:468])
    points = landmarks[[4, 50, 280, 9, 199]] + (0.7, -0.4)
    np.testing.assert_allclose(warp.map(points), oracle(points), atol=0.05)


def test_poses_that_differ_too_much_are_refused(landmarks: np.ndarray) -> None:
    FaceWarp.between(landmarks, turn(landmarks, 10)).refuse_other_pose(NAMES)
    with pytest.raises(InputError, match=r"a\.jpg and b\.jpg differ too much"):
        FaceWarp.between(landmarks, turn(landmarks, 40)).refuse_other_pose(NAMES)


def test_samples_are_those_of_pixel_centres() -> None:
    image = np.arange(12, dtype=np.float32).reshape(3, 4, 1)
    found = sample_at(image, np.array([[0.5, 0.5], [2.0, 1.5], [9.0, 1.0]]))
    np.testing.assert_allclose(found[:, 0], [0, 5.5, np.nan])
