"""Scales of the hybrid model's features, which mix units."""

import numpy as np
import torch
from jaxtyping import Bool, Float

from skinnet.appearance.stack import SubjectStack

LEAST_SCALE = 1e-4
"""Least scale; smaller variation of a channel is rounding error, which must not be amplified."""


def compute_equal_variance(
    grams: Float[np.ndarray, "5 subjects subjects"], texels: int
) -> Float[np.ndarray, "5"]:
    """Compute scales that give hemoglobin, melanin and the offset the same total variance.

    The three channels of the offset share one scale, so they keep their proportions.
    """
    blood, mel, *offset = np.trace(grams, axis1=1, axis2=2) / (grams.shape[1] - 1) / texels
    variances = np.array([blood, mel, *[sum(offset)] * 3])
    return np.asarray(np.maximum(np.sqrt(variances), LEAST_SCALE))


def compute_equal_effect(
    stack: SubjectStack, mask: Bool[np.ndarray, "size size"] | None = None
) -> Float[np.ndarray, "5"]:
    """Compute scales by which a unit of each feature changes linear RGB by one, at its mean."""
    blocks = stack.read_blocks(stack.cover().mask if mask is None else mask)
    total = sum(block.sum((0, 2), dtype=np.float64) for block in blocks)
    mean = torch.from_numpy(total / (blocks.shape[0] * blocks.shape[2]))[:, None]
    derivatives = torch.autograd.functional.jacobian(stack.colour, mean)
    return np.asarray(1 / derivatives.flatten(1).norm(dim=0).numpy())
