"""A similarity transform is recovered, and the best mirroring one."""

import numpy as np

from skinnet.shape.similarity import fit_similarity


def test_similarity_and_the_best_mirrored_one() -> None:
    rng = np.random.default_rng(1)
    source = rng.normal(size=(12, 3))
    rotation = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    rotation *= np.sign(np.linalg.det(rotation))
    target = 3 * source @ rotation.T + [1, 2, 3]
    found = fit_similarity(source, target)
    np.testing.assert_allclose(found(source), target, atol=1e-12)
    np.testing.assert_allclose(found.apply_inverse(target), source, atol=1e-12)
    mirrored = fit_similarity(source * [-1, 1, 1], target, reflection=True)
    np.testing.assert_allclose(mirrored(source * [-1, 1, 1]), target, atol=1e-12)
    assert np.linalg.det(mirrored.rotation) < 0
    plain = fit_similarity(source * [-1, 1, 1], target)
    assert np.abs(plain(source * [-1, 1, 1]) - target).max() > 0.5
