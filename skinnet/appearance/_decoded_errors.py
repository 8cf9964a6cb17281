"""Differences in RGB between mixtures of subjects and subjects when decoding is not linear."""

from collections.abc import Callable

import numpy as np
from jaxtyping import Bool, Float, Float32

from skinnet.appearance._feature_blocks import FeatureBlocks, compute_block_width

Decode = Callable[
    [Float32[np.ndarray, "faces channels texels"]], Float32[np.ndarray, "faces 3 texels"]
]


def compute_decoded_errors(
    blocks: FeatureBlocks, decode: Decode, weights: Float[np.ndarray, "mixtures subjects"]
) -> Float[np.ndarray, "mixtures subjects"]:
    """Compute the RMS difference in RGB between each decoded mixture and each subject."""
    subjects, channels, texels = blocks.shape
    squares = np.zeros((len(weights), subjects))
    single = weights.astype(np.float32)
    for block in blocks:
        colours = decode(block)
        mean = colours.mean(0)
        truth = _center(colours, mean)
        squares += (truth**2).sum(1)
        step = compute_block_width(block.shape[2], channels)
        for start in range(0, len(weights), step):
            part = slice(start, start + step)
            mixed = _center(decode(np.tensordot(single[part], block, 1)), mean)
            squares[part] += (mixed**2).sum(1)[:, None] - 2 * mixed @ truth.T
    return np.asarray(np.sqrt(np.maximum(squares, 0) / (3 * texels)))


def _center(
    colours: Float32[np.ndarray, "faces 3 texels"], mean: Float32[np.ndarray, "3 texels"]
) -> Float[np.ndarray, "faces values"]:
    # A small distance is a difference of large squares; centring and float64 keep it accurate.
    return np.asarray((colours - mean).reshape(len(colours), -1), np.float64)


def subsample(
    mask: Bool[np.ndarray, "size size"], texels: int | None
) -> Bool[np.ndarray, "size size"]:
    """Keep that many random texels of a mask, or all if None; the choice is always the same."""
    inside = np.flatnonzero(mask)
    if texels is None or texels >= inside.size:
        return mask
    chosen = np.zeros_like(mask)
    chosen.flat[np.random.default_rng(0).choice(inside, texels, replace=False)] = True
    return chosen
