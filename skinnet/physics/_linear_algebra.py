"""Products and inverses of small matrices, in operators that ONNX has."""

import torch
from jaxtyping import Float
from torch import Tensor


def apply_matrix(
    spectra: Float[Tensor, "*shape wavelength"], matrix: Float[Tensor, "*batch wavelength 3"]
) -> Float[Tensor, "*shape 3"]:
    """Multiply spectra [*batch, ..., 33] by one matrix for each element of the batch."""
    batch = matrix.ndim - 2
    flat = spectra.flatten(batch, -2) if spectra.ndim - 1 > batch else spectra[..., None, :]
    product = flat @ matrix
    return product.reshape(*product.shape[:-2], *spectra.shape[batch:-1], 3)


def invert_3x3(matrix: Float[Tensor, "*batch 3 3"]) -> Float[Tensor, "*batch 3 3"]:
    """Invert 3 x 3 matrices by cofactors: ONNX has no operator for an inverse."""
    a, b, c = matrix.unbind(-1)
    rows = torch.stack([_cross(b, c), _cross(c, a), _cross(a, b)], -2)
    return rows / (a * rows[..., 0, :]).sum(-1)[..., None, None]


def _cross(a: Float[Tensor, "*batch 3"], b: Float[Tensor, "*batch 3"]) -> Float[Tensor, "*batch 3"]:
    return a.roll(-1, -1) * b.roll(-2, -1) - a.roll(-2, -1) * b.roll(-1, -1)
