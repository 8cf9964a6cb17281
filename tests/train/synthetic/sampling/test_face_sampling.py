"""Random faces."""

import numpy as np

from train.synthetic.sampling.face_sampling import MELANIN_RANGE, sample_face


def test_faces_cover_pale_and_dark_skin_evenly() -> None:
    low, high = np.log(MELANIN_RANGE)
    faces = [sample_face(np.random.default_rng(seed)) for seed in range(100)]
    melanin = np.array([face.skin.melanin.fraction.log().item() for face in faces])
    assert 0.38 < np.mean(melanin < (low + high) / 2) < 0.62
