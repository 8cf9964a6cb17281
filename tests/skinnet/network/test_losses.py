"""Losses are zero for perfect readings, and have the values of their equations."""

import math

import numpy as np
import pytest
import torch
from plain_maps import capture, maps
from scipy.stats import norm

from skinnet.network import F_MEL_MAX, SkinMaps, Uncertainty, losses, priors


def test_a_perfect_reading_costs_nothing() -> None:
    truth = maps()
    photograph = torch.rand(2, 3, 8, 8)
    ones = torch.ones(2, 8, 8)
    assert losses.appearance_l1(photograph, photograph, ones) == 0
    assert losses.pigment_l1(truth, truth) == 0 and losses.lighting_error(truth, truth) == 0
    assert (
        losses.pigment_mse(truth, truth) == 0 and losses.error_shading_covariance(truth, truth) == 0
    )
    assert losses.soft_iou(truth, ones) == pytest.approx(0, abs=1e-6)
    assert priors.camera_prior(capture()) == 0
    assert priors.off_skin_shading(truth, ones) == 0
    assert priors.shading_smoothness(truth, ones) == 0
    assert losses.mask_cross_entropy(truth, ones) == pytest.approx(0, abs=1e-5)


def test_appearance_counts_where_the_weight_is() -> None:
    photograph = torch.zeros(2, 3, 8, 8)
    weight = torch.zeros(2, 8, 8)
    weight[:, :4] = 1
    wrong = photograph.clone()
    wrong[:, :, 4:] = 9
    assert losses.appearance_l1(wrong, photograph, weight) == 0
    assert losses.appearance_l1(photograph + 0.25, photograph, weight) == pytest.approx(0.25)


def test_saturated_pixels_may_be_predicted_brighter_but_not_darker() -> None:
    photograph, ones = torch.ones(2, 3, 8, 8), torch.ones(2, 8, 8)
    made = torch.full_like(photograph, 1.5).requires_grad_()
    assert losses.appearance_l1(made, photograph, ones) == 0
    assert losses.appearance_l1(made - 0.75, photograph, ones).item() == pytest.approx(0.25)
    # Below saturation, too bright is wrong and has a gradient.
    loss = losses.appearance_l1(made, 0.9 * photograph, ones)
    loss.backward()
    assert loss.item() == pytest.approx(0.6) and made.grad is not None and (made.grad > 0).all()


def test_pigment_l1_is_in_cube_roots() -> None:
    truth, guess = maps(), maps(melanin=torch.full((2, 8, 8), 8 * 0.05))
    root = (0.05 / 0.43) ** (1 / 3)
    assert losses.pigment_l1(guess, truth).item() == pytest.approx(root, abs=1e-4)


def test_pigment_mse_is_in_standard_deviations() -> None:
    melanin, blood = losses.PIGMENT_SD
    guess = maps(melanin=0.05 + torch.full((2, 8, 8), 2 * melanin))
    assert losses.pigment_mse(guess, maps()).item() == pytest.approx(4, rel=1e-4)
    guess = maps(hemoglobin=0.05 - torch.full((2, 8, 8), blood))
    assert losses.pigment_mse(guess, maps()).item() == pytest.approx(1, rel=1e-4)


def test_error_shading_covariance_rewards_an_error_that_rises_with_shading() -> None:
    # The gradient tilts an absolute error towards more melanin where the light is strong.
    shading = torch.linspace(0, 2 * losses.MEAN_SHADING, 64).reshape(1, 8, 8).expand(2, 8, 8)
    guess = torch.full((2, 8, 8), 0.05, requires_grad=True)
    bright = maps(shading=torch.full((2, 8, 8), 9.0))
    more = (0.1 / F_MEL_MAX) ** (1 / 3) - (0.05 / F_MEL_MAX) ** (1 / 3)
    cut = losses.error_shading_covariance(maps(melanin=torch.full((2, 8, 8), 0.1)), bright)
    assert cut.item() == pytest.approx(-more * (2 - losses.MEAN_SHADING), rel=1e-4)
    found = losses.error_shading_covariance(maps(melanin=guess), maps(shading=shading))
    assert found.item() == pytest.approx(0, abs=1e-6)
    (gradient,) = torch.autograd.grad(found, guess)
    assert (gradient[shading > losses.MEAN_SHADING] < 0).all() and (
        gradient[shading < losses.MEAN_SHADING] > 0
    ).all()


def test_soft_iou_is_of_masks_above_one_half() -> None:
    skin = torch.zeros(2, 8, 8)
    skin[:, :4] = 0.6
    skin[:, 4:] = 0.4
    guess = torch.zeros(2, 8, 8)
    guess[:, 2:6] = 1
    assert losses.soft_iou(maps(mask=guess), skin).item() == pytest.approx(1 - 17 / 49)
    nothing = maps(mask=torch.zeros(2, 8, 8))
    assert losses.soft_iou(nothing, 0.1 * skin) == 0
    assert losses.soft_iou(maps(), 0.1 * skin) > 0.9


def test_white_balance_l1_is_in_standard_deviations() -> None:
    found = losses.white_balance_l1(capture(balance=0.05), capture())
    assert found.item() == pytest.approx(1)


def test_the_loss_of_a_batch_is_the_mean_of_those_of_its_halves() -> None:
    # Then the mean over processes that share a batch is the loss of the batch.
    torch.manual_seed(0)
    photograph, made = torch.rand(2, 4, 3, 32, 32)
    mask = torch.rand(4, 32, 32) * torch.tensor([0.0, 0.1, 0.5, 1.0])[:, None, None]
    guess, truth = (
        SkinMaps(*torch.rand(4, 4, 32, 32), torch.rand(4, 3, 32, 32), torch.rand(4, 32, 32))
        for _ in range(2)
    )

    def found(part: slice) -> torch.Tensor:
        one, other = (SkinMaps(*(value[part] for value in each)) for each in (guess, truth))
        return torch.stack([
            losses.appearance_l1(made[part], photograph[part], mask[part]),
            priors.specular_sparsity(one, mask[part]),
            priors.shading_smoothness(one, mask[part]),
            priors.shading_from_luminance(one, photograph[part], mask[part]),
            priors.off_skin_shading(one, mask[part]),
            losses.mask_cross_entropy(one, mask[part]),
            losses.pigment_l1(one, other),
            losses.pigment_mse(one, other),
            losses.error_shading_covariance(one, other),
            losses.soft_iou(one, mask[part]),
            losses.lighting_error(one, other),
        ])  # fmt: skip

    halves = (found(slice(0, 2)) + found(slice(2, 4))) / 2
    torch.testing.assert_close(found(slice(0, 4)), halves)


def test_the_mask_loss_is_a_cross_entropy_that_accepts_nan() -> None:
    guess, truth = torch.rand(2, 8, 8), torch.rand(2, 8, 8)
    found = losses.mask_cross_entropy(maps(mask=guess), truth)
    torch.testing.assert_close(found, torch.nn.functional.binary_cross_entropy(guess, truth))
    assert losses.mask_cross_entropy(maps(mask=guess / 0 * 0), truth).isnan()


def test_gradients_are_finite_at_the_edges() -> None:
    zero = torch.zeros(2, 8, 8)
    truth = maps(specular=zero)
    guess = [value.clone().requires_grad_() for value in maps(melanin=zero, shading=zero)]
    found = SkinMaps(*guess)
    total = (
        losses.pigment_l1(found, truth)
        + losses.pigment_mse(found, truth)
        + losses.error_shading_covariance(found, truth)
        + losses.soft_iou(found, 0 * truth.mask)
        + losses.lighting_error(found, truth)
        + priors.shading_smoothness(found, truth.mask)
        + losses.mask_cross_entropy(found, 0 * truth.mask)
    )
    for gradient in torch.autograd.grad(total, guess, allow_unused=True):
        assert gradient is None or gradient.isfinite().all()


def test_the_likelihood_is_that_of_normal_errors_of_logarithms() -> None:
    truth = maps()
    guess = truth._replace(melanin=truth.melanin * 1.2, hemoglobin=truth.hemoglobin / 1.1)
    pixel, face = torch.full((2, 8, 8), 0.3), torch.full((2, 2), 0.1)
    found = losses.pigment_likelihood(guess, Uncertainty(pixel, pixel, face), truth)
    scores = [-norm(0, d).logpdf(e) for d in (0.3, 0.1) for e in np.log([1.2, 1 / 1.1])]
    assert found.item() == pytest.approx(np.mean(scores) * 2 - math.log(2 * math.pi), rel=1e-4)


def test_the_likelihood_is_smallest_for_the_true_deviation_and_moves_no_map() -> None:
    torch.manual_seed(0)
    truth = maps()
    melanin = (truth.melanin * torch.exp(0.2 * torch.randn(2, 8, 8))).requires_grad_()
    scale = torch.tensor([0.1, 0.2, 0.4], requires_grad=True)
    costs = []
    for one in scale:
        spread = Uncertainty(one.expand(2, 8, 8), one.expand(2, 8, 8), 0 * one.expand(2, 2) + 1)
        costs.append(losses.pigment_likelihood(truth._replace(melanin=melanin), spread, truth))
    assert costs[1] < costs[0]
    sum(costs).backward()
    assert melanin.grad is None and scale.grad is not None
