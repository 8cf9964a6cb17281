"""Weights of format 3, whose network knew nothing of a capture and stated no uncertainty."""

from collections.abc import Mapping
from typing import Any

import torch
from torch import Tensor

EARLIER_FORMAT = 3

_GROWN = ("encoder.head.last", "encoder.global_outputs", "encoder.white_balance")
"""Layers whose last two outputs, of standard deviations, are missing."""

_LARGEST = 20.0
"""Raw value that stands for the largest standard deviation, for what is not known."""


_EARLIER_NAMES = {
    "scene.": "context.",
    "back.": "broadcast.",
    "gather.look.": "pooling.conv.",
    "gather.attend.": "pooling.attention.",
    "gather.expect.": "pooling.expected_chroma.",
    "weigh.": "refine.",
    "globals.": "global_outputs.",
    "balanced.": "white_balance.",
    "head.look.": "head.conv.",
    "head.mixed.": "head.norm.",
}
"""Prefixes of weights in some files, and their present names."""


def upgrade_config(config: Mapping[str, Any]) -> dict[str, Any]:
    """Add to a configuration of format 3 what it took for granted."""
    return {"white_balance_max": 0.4, **config}


def upgrade_weights(
    state: Mapping[str, Tensor], present: Mapping[str, Tensor]
) -> dict[str, Tensor]:
    """Complete weights of format 3 so that maps are as before and the uncertainty is the largest.

    Args:
        state: The weights.
        present: Weights of a new network, from which those are taken that are missing.

    Returns:
        All weights.
    """
    named = {_rename(name): value for name, value in state.items()}
    grown = {name: _grow(name, value) for name, value in named.items()}
    return {**present, **grown}


def _rename(name: str) -> str:
    encoder = "encoder."
    inside = name.removeprefix(encoder)
    for earlier, present in _EARLIER_NAMES.items():
        if name.startswith(encoder) and inside.startswith(earlier):
            return encoder + present + inside.removeprefix(earlier)
    return name


def _grow(name: str, value: Tensor) -> Tensor:
    layer, _, kind = name.rpartition(".")
    if layer not in _GROWN:
        return value
    more = value.new_zeros(2, *value.shape[1:])
    return torch.cat([value, more + _LARGEST if kind == "bias" else more])


def free_uncertainty(state: Mapping[str, Tensor]) -> dict[str, Tensor]:
    """Start standard deviations that are the largest everywhere, and have no gradient, anew.

    Args:
        state: Weights of an encoder.

    Returns:
        The same weights, with the raw value 0 of such standard deviations.
    """
    freed = {name: value.clone() for name, value in state.items()}
    for layer in _GROWN:
        bias = freed.get(f"{layer.removeprefix('encoder.')}.bias")
        if bias is not None and bool((bias[-2:] > _LARGEST / 2).all()):
            bias[-2:] = 0
    return freed
