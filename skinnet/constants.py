"""Constants of physics modules: buffers by default, parameters where one is handed in."""

import torch
from torch import Tensor, nn


def register_constant(
    module: nn.Module,
    name: str,
    value: float | Tensor | None,
    dtype: torch.dtype,
    persistent: bool = True,
) -> None:
    """Register `value` under `name`: an `nn.Parameter` as itself, anything else as a buffer."""
    if isinstance(value, nn.Parameter):
        module.register_parameter(name, value)
    elif value is None:
        module.register_buffer(name, None)
    else:
        constant = torch.as_tensor(value, dtype=dtype).clone(memory_format=torch.contiguous_format)
        module.register_buffer(name, constant, persistent)
