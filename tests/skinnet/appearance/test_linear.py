"""The linear model is a principal component analysis of linear RGB."""

import numpy as np

from skinnet.appearance import LinearModel, SubjectStack


def test_its_components_are_those_of_the_albedos(stack: SubjectStack) -> None:
    model = LinearModel.fit(stack)
    albedos = np.stack([stack.texture(i).albedo(stack.colour) for i in range(len(stack.names))])
    pixels = albedos[:, model.mask].reshape(len(albedos), -1).astype(np.float64)
    singular = np.linalg.svd(pixels - pixels.mean(0), compute_uv=False)
    assert np.allclose(model.statistics.variances, singular[:6] ** 2 / 6, rtol=1e-4)
    mean = model.reconstruct(np.zeros(6))[model.mask]
    assert np.allclose(mean.ravel(), pixels.mean(0), atol=1e-6)
