"""Colours of skins at the nodes have the mean and spread of skins that the prior samples."""

import torch

from skinnet.physics._posterior_nodes import tabulate_nodes
from skinnet.physics.nuisance import Nuisance
from skinnet.physics.prior import SkinPrior
from skinnet.physics.reflectance import SkinReflectance
from skinnet.physics.sources import load_spectrum_to_srgb
from skinnet.physics.specular import R_SURFACE

D = torch.float64
MATRIX, SKIN, PRIOR = (
    load_spectrum_to_srgb("D65", "mean"),
    SkinReflectance(dtype=D),
    SkinPrior(),
)


def test_mean_and_covariance_are_those_of_sampled_nuisance() -> None:
    nodes = tabulate_nodes(SKIN, MATRIX, PRIOR, 0.003, 0.02)
    rng, count = torch.Generator().manual_seed(0), 20_000
    likely = nodes.log_prior.topk(600).indices[::150]
    for node in likely:
        f_mel, f_blood = (nodes.moments[node, k].expand(count) for k in (4, 6))
        mean, covariance, leftover = PRIOR.condition(f_mel[:1], f_blood[:1])
        normal = torch.randn(count, 4, generator=rng, dtype=D)
        deviations = torch.stack(list(mean), -1) + normal @ torch.linalg.cholesky(covariance[0]).T
        nuisance = Nuisance(*deviations.unbind(-1))
        rest = torch.randn(count, 33, generator=rng, dtype=D) @ torch.linalg.cholesky(leftover[0]).T
        rest = (rest + PRIOR.leftover_mean(f_mel, nuisance, f_blood)) / (1 - R_SURFACE)
        colours = (SKIN(f_mel, f_blood, nuisance) + rest) @ MATRIX
        gains = 1 + 0.02 * torch.randn(count, 3, generator=rng, dtype=D)
        gains[:, 1] = 1
        colours = colours * gains + 0.003 * torch.randn(count, 3, generator=rng, dtype=D)
        sd = colours.std(0)
        assert ((nodes.colour[node] - colours.mean(0)) / sd).abs().max() < 0.05
        ratio = nodes.covariance[node] / colours.T.cov()
        assert (ratio - 1).abs().max() < 0.15


def test_the_nodes_hold_the_priors_mass_and_moments() -> None:
    nodes = tabulate_nodes(SKIN, MATRIX, PRIOR, 0.0, 0.0)
    weights = torch.softmax(nodes.log_prior, 0)
    f_mel, f_blood, _, _ = PRIOR.sample(50_000, torch.Generator().manual_seed(0))
    for column, sampled in ((0, f_mel.log()), (2, f_blood.log()), (4, f_mel), (6, f_blood)):
        mean, square = weights @ nodes.moments[:, column], weights @ nodes.moments[:, column + 1]
        assert abs(mean - sampled.mean()) < 0.02 * sampled.std()
        assert abs((square - mean**2).sqrt() / sampled.std() - 1) < 0.02
    assert abs(nodes.mel_variance**0.5 / f_mel.log().std() - 1) < 0.02
