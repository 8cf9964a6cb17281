"""What the features of the hybrid model are divided by, since they mix units."""

import numpy as np
import torch
from jaxtyping import Bool, Float

from skinnet.appearance.stack import SubjectStack

LEAST_SCALE = 1e-4
"""Least deviation that a block is divided by; what varies less is rounding and stays small."""


def equal_variance(
    grams: Float[np.ndarray, "5 subjects subjects"], texels: int
) -> Float[np.ndarray, "5"]:
    """Scales that give hemoglobin, melanin and the offset the same total variance.

    The offset is one block: its three channels keep their proportions.
    """
    blood, mel, *offset = np.trace(grams, axis1=1, axis2=2) / (grams.shape[1] - 1) / texels
    variances = np.array([blood, mel, *[sum(offset)] * 3])
    return np.asarray(np.maximum(np.sqrt(variances), LEAST_SCALE))


def equal_effect(
    stack: SubjectStack, mask: Bool[np.ndarray, "size size"] | None = None
) -> Float[np.ndarray, "5"]:
    """Scales that make a unit of every feature change linear RGB by one, at the mean colour.

    Components are then ordered by what is seen of them, to first order.
    """
    columns = stack.read_blocks(stack.cover().mask if mask is None else mask)
    total = sum(block.sum((0, 2), dtype=np.float64) for block in columns)
    mean = torch.from_numpy(total / (columns.shape[0] * columns.shape[2]))[:, None]
    slopes = torch.autograd.functional.jacobian(stack.colour, mean)
    return np.asarray(1 / slopes.flatten(1).norm(dim=0).numpy())
